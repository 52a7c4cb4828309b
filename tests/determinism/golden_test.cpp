// Golden hashes: the state of every scenario after its last tick, equal for every compiler and optimisation.
//
// They change only on purpose: with a change of the model, whose commit says so.

#include "server/base/inline_executor.h"
#include "server/base/instructions.h"
#include "tests/determinism/scenarios.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace evod::scenarios {
namespace {

const std::map<std::string, std::string> golden_hashes = {
    {"default_world", "d8410c8b5d813d1023033ee0333a59f8"},
    {"classic", "0ebc136ce34a3c8d0745fed030ecbff4"},
    {"crates_and_obstacles_explicit_euler", "f7774b4d7900dbd6093f6112b4e42308"},
    {"dense_backward_euler", "8de7f59cbde42906d9a6a25821ca6a66"},
    {"ring_of_four", "3c834e375857ca21f9fdf670ab9b831b"},
    {"trade_offs_dying_out", "9209a877b5e7ee4fb20548d2acb94590"},
    {"changes_while_it_runs", "b8ec924ea3caa2031f469d1f39020c17"},
    {"three_thousand", "29cdaef6beb81d640a008a387624d0f8"},
    {"twenty_thousand", "bd1e54ae94362c37c66b2b85f07cde5d"},
    {"far_corner", "65d9635639fa5527cc32f4ed071f3336"},
    {"rastrigin", "6f8c8ba85d02b6725b8107a0c1b60946"},
};

class GoldenHash : public testing::TestWithParam<Scenario> {};
INSTANTIATE_TEST_SUITE_P(All, GoldenHash, testing::ValuesIn(all()), testing::PrintToStringParamName());

void expect_golden_hash(const Scenario& scenario) {
    Play run{scenario};
    base::InlineExecutor executor;
    for (std::uint64_t tick = 1; tick <= scenario.ticks; ++tick)
        run.advance(executor);
    const auto known = golden_hashes.find(scenario.name);
    EXPECT_EQ(base::to_text(run.world().hash()), known == golden_hashes.end() ? "unknown" : known->second)
        << scenario.name;
}

TEST_P(GoldenHash, IsTheSameInEveryBuild) {
    expect_golden_hash(GetParam());
}

TEST_P(GoldenHash, IsTheSameWithTheInstructionsOfEveryProcessor) {
    const base::Instructions widest = base::widest_instructions();
    if (widest == base::Instructions::Baseline)
        GTEST_SKIP() << "this processor has no others";
    base::use_instructions(base::Instructions::Baseline);
    expect_golden_hash(GetParam());
    base::use_instructions(widest);
}

TEST(GoldenHashes, AreKnownForEveryScenarioAndNoOther) {
    EXPECT_EQ(golden_hashes.size(), all().size());
}

TEST(TheScenarios, UseWhatTheyAreFor) {
    base::InlineExecutor executor;
    std::uint64_t limited = 0, deaths = 0, poisoned = 0, clamped = 0, generations = 0, extinct = 0;
    for (const Scenario& scenario : all()) {
        Play run{scenario};
        for (std::uint64_t tick = 1; tick <= scenario.ticks; ++tick)
            run.advance(executor);
        for (const auto& generation : run.world().history())
            for (const simulation::GenerationStatistics& s : generation) {
                limited += s.speed_limit_count;
                deaths += s.starved_count;
                poisoned += s.poisoned_count;
                clamped += s.clamp_count;
                extinct += s.alive_count == 0;
                ++generations;
            }
        EXPECT_GE(run.world().moment().generation, 2u) << scenario.name;
    }
    EXPECT_GT(limited, 0u);
    EXPECT_GT(deaths, 100u);
    EXPECT_GE(poisoned, 5u);
    EXPECT_GT(clamped, 0u);
    EXPECT_GT(extinct, 2u);
    EXPECT_GT(generations, 100u);
}

} // namespace
} // namespace evod::scenarios
