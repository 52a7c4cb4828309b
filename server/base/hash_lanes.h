// Computes the hashes of several entities at once, for kernels (lanes.h). Each lane gives the same result as hash_of()
// in state_hash.h.
#pragma once

#include "server/base/lanes.h"

namespace evod::base {
namespace {

/// Sums of the two words that hash_of() returns, over all entities that were added. Each lane has its own sums.
struct HashSumsPerLane {
    Longs low{}, high{};

    /// Adds the hash of one entity per lane, but only in the lanes of `lanes_used` whose bits are all set, as a
    /// comparison sets them.
    void add(Words kind_and_id, Words a, Words b, Words c, Words d, Words e, Integers lanes_used) {
        const Words key = kind_and_id * 0x9e3779b1u;
        a ^= key;
        b ^= key ^ 0x27d4eb2fu;
        c ^= key ^ 0xc2b2ae35u;
        d ^= key ^ 0x165667b1u;
        e ^= key;
        const Words last = key ^ 0xd3a2646cu;
        Hash even = hash_of(multiply_low_halves(even_lanes(a), even_lanes(b)),
                            multiply_low_halves(even_lanes(c), even_lanes(d)),
                            multiply_low_halves(even_lanes(e), even_lanes(last)), even_pairs(a, b), even_pairs(c, d));
        Hash odd =
            hash_of(multiply_low_halves(odd_lanes(a), odd_lanes(b)), multiply_low_halves(odd_lanes(c), odd_lanes(d)),
                    multiply_low_halves(odd_lanes(e), odd_lanes(last)), odd_pairs(a, b), odd_pairs(c, d));
        if (bits_of(lanes_used) != (1u << lanes) - 1) { // rare: only in the last step of a block
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
    static Hash hash_of(Longs ab, Longs cd, Longs fifth, Longs a_and_b, Longs c_and_d) {
        Longs l = ab + c_and_d + fifth;
        Longs h = cd + a_and_b + exchanged_halves(fifth);
        l += multiply_low_halves(h, h >> 32);
        h ^= exchanged_halves(l);
        h += multiply_low_halves(l, l >> 32);
        l ^= h >> 29;
        return {l, h};
    }
};

inline std::uint64_t sum_of(Longs v) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < lanes / 2; ++i) {
        sum += v[i];
    }
    return sum;
}

} // namespace
} // namespace evod::base
