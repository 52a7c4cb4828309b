// Golden hashes: the state of every scenario after its last tick, equal for every compiler and optimisation.
//
// They change only on purpose: with a change of the model, whose commit says old and new. Then old runs are of another
// model and the model version of run files rises.

#include "server/base/inline_executor.h"
#include "tests/determinism/scenarios.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace evod::scenarios {
namespace {

const std::map<std::string, std::string> golden_hashes = {
    {"default_world", "a97b984d68722e3ec54286f32dd6aaae"},
    {"classic", "23f50af36f9299171b996db17b518bea"},
    {"crates_and_obstacles_explicit_euler", "9151baaf514cd5b796205f77e41e9351"},
    {"dense_backward_euler", "c13e800019bacde079e448d6a4500d6e"},
    {"ring_of_four", "81b2c9d363bdb4c1741197b8a7a1a5ab"},
    {"trade_offs_dying_out", "2f351e73019bd8636cd21d630a0772e0"},
    {"changes_while_it_runs", "43f19832846e0e414e8556c910cddb67"},
    {"three_thousand", "ffea8c10097b432233a1c01fe35d6e95"},
    {"far_corner", "c07ebb8321273e40fc69960226e56d3f"},
    {"rastrigin", "d6e40c32d8dc0c4edf808f0c43955f1d"},
};

class GoldenHash : public testing::TestWithParam<Scenario> {};
INSTANTIATE_TEST_SUITE_P(All, GoldenHash, testing::ValuesIn(all()), testing::PrintToStringParamName());

TEST_P(GoldenHash, IsTheSameInEveryBuild) {
    const Scenario& scenario = GetParam();
    Play run{scenario};
    base::InlineExecutor executor;
    for (std::uint64_t tick = 1; tick <= scenario.ticks; ++tick)
        run.advance(executor);
    const auto known = golden_hashes.find(scenario.name);
    EXPECT_EQ(base::to_text(run.world().hash()), known == golden_hashes.end() ? "unknown" : known->second)
        << scenario.name;
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
    EXPECT_GT(poisoned, 5u);
    EXPECT_GT(clamped, 0u);
    EXPECT_GT(extinct, 2u);
    EXPECT_GT(generations, 100u);
}

} // namespace
} // namespace evod::scenarios
