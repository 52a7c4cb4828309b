#include "server/evolution/rare_events.h"

#include "tests/unit/evolution/draws.h"

#include <gtest/gtest.h>

#include <cmath>

namespace evod::evolution {
namespace {

TEST(RareEvents, EachTrialSucceedsWithItsChance) {
    // Law: how often each of 144 trials succeeds is binomial. Chi-square of the successes, 144 degrees of freedom.
    for (const double chance : {0.125, 0.01, 0.0003}) {
        const RareEvents events{144, chance};
        constexpr std::uint64_t draws = 200'000;
        base::RandomStream random = stream_of(251);
        std::vector<std::uint64_t> successes(144);
        for (std::uint64_t i = 0; i < draws; ++i) {
            events.draw(random, [&](unsigned trial) { ++successes.at(trial); });
        }
        double statistic = 0;
        for (const std::uint64_t count : successes) {
            const double difference = static_cast<double>(count) - draws * chance;
            statistic += difference * difference / (draws * chance * (1 - chance));
        }
        EXPECT_GT(support::p_value(statistic, 144), alpha) << chance;
    }
}

TEST(RareEvents, TrialsAreIndependent) {
    // Law: each of the 16 patterns of 4 trials, a product of chances. Chi-square, 15 degrees of freedom.
    constexpr double chance = 0.3;
    const RareEvents events{4, chance};
    base::RandomStream random = stream_of(252);
    std::vector<std::uint64_t> patterns(16);
    for (int i = 0; i < 300'000; ++i) {
        unsigned pattern = 0;
        events.draw(random, [&](unsigned trial) { pattern |= 1u << trial; });
        ++patterns[pattern];
    }
    std::vector<double> law;
    for (int pattern = 0; pattern < 16; ++pattern) {
        const int successes = __builtin_popcount(static_cast<unsigned>(pattern));
        law.push_back(std::pow(chance, successes) * std::pow(1 - chance, 4 - successes));
    }
    EXPECT_GT(p_value_of_law(patterns, law), alpha);
}

TEST(RareEvents, NothingSucceedsWithoutTrialsOrChance) {
    base::RandomStream random = stream_of(253);
    for (const RareEvents& events : {RareEvents{0, 0.1}, RareEvents{144, 0}, RareEvents{144, 1e-18}}) {
        for (int i = 0; i < 10'000; ++i) {
            events.draw(random, [](unsigned trial) { FAIL() << trial; });
        }
    }
}

} // namespace
} // namespace evod::evolution
