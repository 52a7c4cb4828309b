// Rare events: which of many trials, each with the same small probability, succeed. Draws how many trials fail before
// the next success: one word per event, rather than a few bits per trial.
//
// Source  geometric skips by inversion: Devroye 1986, Non-Uniform Random Variate Generation, III.2 and X.2.
#pragma once

#include "server/base/assert.h"
#include "server/base/random.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace evod::evolution {

class RareEvents {
  public:
    static constexpr unsigned trials_max = 160;

    /// trials  the number of trials, at most trials_max.
    /// chance  the probability that a trial succeeds, in [0, 1); rounded to a multiple of 2^-53.
    RareEvents(unsigned trials, double chance) : trials_{trials} {
        EVOD_ASSERT(trials <= trials_max);
        EVOD_ASSERT(chance >= 0);
        EVOD_ASSERT(chance < 1);
        double failures = 1;
        for (unsigned i = 0; i < trials; ++i) {
            failures *= 1 - chance;
            const auto digits = static_cast<std::uint64_t>(std::min(failures, 1 - 0x1p-53) * 0x1p64);
            all_fail_[i] = {static_cast<std::uint32_t>(digits >> 32), static_cast<std::uint32_t>(digits)};
        }
        unsigned skip = trials;
        for (unsigned i = 0; i < guides; ++i) { // the larger the word, the earlier the success
            const std::uint32_t least = i * (0xffffffffu / guides + 1);
            while (skip > 0 && all_fail_[skip - 1].high < least) {
                --skip;
            }
            guide_[i] = static_cast<std::uint8_t>(skip);
        }
    }

    /// Calls visit(trial) for each trial that succeeds, in order.
    template <class Visit>
    void draw(base::RandomStream& random, const Visit& visit) const {
        for (unsigned trial = skip(random); trial < trials_; trial += 1 + skip(random)) {
            visit(trial);
        }
    }

  private:
    /// Draws how many trials fail before the first success: k + 1 or more with probability all_fail_[k]; trials_ if
    /// none succeeds.
    unsigned skip(base::RandomStream& random) const {
        const std::uint32_t high = random.word();
        unsigned skip = guide_[high / (0xffffffffu / guides + 1)];
        while (skip > 0 && all_fail_[skip - 1].high < high) {
            --skip;
        }
        // If the first word fits two answers, a second word decides.
        if (skip == 0 || all_fail_[skip - 1].high != high) {
            return skip;
        }
        const std::uint32_t low = random.word();
        while (skip > 0 && all_fail_[skip - 1].high == high && all_fail_[skip - 1].low <= low) {
            --skip;
        }
        return skip;
    }

    /// A probability as two words of binary digits.
    struct Digits {
        std::uint32_t high, low;
    };
    static constexpr unsigned guides = 1024; // enough that most words need no search
    unsigned trials_;
    std::array<Digits, trials_max> all_fail_{}; // [k]: the probability that the first k + 1 trials all fail
    std::array<std::uint8_t, guides> guide_{};  // [leading digits of a word]: the greatest possible skip
};

} // namespace evod::evolution
