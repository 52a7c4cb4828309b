// The hash of many entities at once, for kernels (lanes.h): lane for lane what hash_of() of state_hash.h gives for one.
#pragma once

#include "server/base/lanes.h"

namespace evod::base {
namespace {

/// Sums over lanes of the two words of hash_of().
struct HashSums {
    Longs low{}, high{};

    /// lanes_used  a comparison: all bits set where a lane counts.
    void add(Words kind_and_id, Words a, Words b, Words c, Words d, Words e, Integers lanes_used) {
        Hash even = hash_of(even_lanes(kind_and_id), even_lanes(a), even_lanes(b), even_lanes(c), even_lanes(d),
                            even_lanes(e), even_pairs(a, b), even_pairs(c, d));
        Hash odd = hash_of(odd_lanes(kind_and_id), odd_lanes(a), odd_lanes(b), odd_lanes(c), odd_lanes(d), odd_lanes(e),
                           odd_pairs(a, b), odd_pairs(c, d));
        if (bits_of(lanes_used) != (1u << lanes) - 1) { // seldom
            const auto used = (Words)lanes_used;
            even = {even.low & even_pairs(used, used), even.high & even_pairs(used, used)};
            odd = {odd.low & odd_pairs(used, used), odd.high & odd_pairs(used, used)};
        }
        low += even.low + odd.low;
        high += even.high + odd.high;
    }

  private:
    struct Hash {
        Longs low, high;
    };
    /// Of single words, the upper halves may hold anything.
    static Hash hash_of(Longs kind_and_id, Longs a, Longs b, Longs c, Longs d, Longs e, Longs a_and_b, Longs c_and_d) {
        const Longs start = multiply_low_halves(kind_and_id, Longs{} + 0x9e3779b1u);
        const Longs key = start + (start << 32), high_key = key >> 32;
        const Longs first = multiply_low_halves(a ^ key, b ^ high_key);
        const Longs second = multiply_low_halves(c ^ key ^ 0xc2b2ae35u, d ^ high_key ^ 0x27d4eb2fu);
        const Longs third = multiply_low_halves(e ^ key ^ 0x165667b1u, high_key ^ 0xd3a2646cu);
        Longs l = first + c_and_d + third;
        Longs h = second + a_and_b + exchanged_halves(third);
        l += multiply_low_halves(h, h >> 32);
        h ^= exchanged_halves(l);
        h += multiply_low_halves(l, l >> 32);
        l ^= h >> 29;
        return {l, h};
    }
};

inline std::uint64_t sum_of(Longs v) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < lanes / 2; ++i)
        sum += v[i];
    return sum;
}

} // namespace
} // namespace evod::base
