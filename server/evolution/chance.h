// Chance: draws random events that happen with a fixed probability p. One random word suffices for many events.
//
// A draw compares the binary digits of a uniform number with the digits of p, from the first digit on. It stops at the
// first difference: after two digits on average. Six genes therefore take little more than one word. The probability of
// an event is exactly p.
// Source  Knuth & Yao 1976, "The complexity of nonuniform random number generation".
#pragma once

#include "server/base/assert.h"
#include "server/base/random.h"

#include <cstdint>

namespace evod::evolution {

class Chance {
  public:
    /// p  the probability of an event, in [0, 1]; rounded to a multiple of 2^-64, which changes p only below 2^-11.
    explicit Chance(double p) : digits_{p < 1 ? static_cast<std::uint64_t>(p * 0x1p64) : 0}, certain_{p >= 1} {
        EVOD_ASSERT(p >= 0);
        EVOD_ASSERT(p <= 1);
    }

    bool is_never() const { return digits_ == 0 && !certain_; }

    /// Sets each of the low `count` bits (1 … 32) with probability p, independently; the other bits are 0. Draws no
    /// word if p is 0 or 1.
    std::uint32_t draw_bits(unsigned count, base::RandomStream& random) const {
        EVOD_ASSERT(count >= 1);
        EVOD_ASSERT(count <= 32);
        const std::uint64_t all = (std::uint64_t{1} << count) - 1;
        if (certain_) {
            return static_cast<std::uint32_t>(all);
        }
        std::uint64_t undecided = all, happens = 0;
        std::uint64_t digits = digits_; // the remaining digits of p; the next digit is the highest bit
        while (undecided != 0 && digits != 0) {
            std::uint64_t word = random.word();
            for (unsigned left = 32; left >= count; left -= count) {
                const std::uint64_t digit_of_p = digits >> 63 != 0 ? all : 0;
                happens |= undecided & digit_of_p & ~word;
                undecided &= ~(digit_of_p ^ word);
                digits <<= 1;
                word >>= count;
            }
        }
        return static_cast<std::uint32_t>(happens);
    }

    bool draw(base::RandomStream& random) const { return draw_bits(1, random) != 0; }

  private:
    std::uint64_t digits_; // p · 2^64; not used if p is 1, which would not fit
    bool certain_;         // whether p is 1
};

} // namespace evod::evolution
