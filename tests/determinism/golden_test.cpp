// Golden hashes: the state of every scenario after its last tick, equal for every compiler and optimisation level.
//
// They change only with a deliberate change of the model; the commit gives the reason.

#include "server/base/inline_executor.h"
#include "server/base/instructions.h"
#include "tests/determinism/scenarios.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <tuple>

namespace evod::scenarios {
namespace {

const std::map<std::string, std::string> golden_hashes = {
    {"default_world", "361930ae0a58d814e3c0d56c1aeae6bc"},
    {"classic", "745222742554fa5bb60703ea4bb9a9c8"},
    {"crates_and_obstacles_explicit_euler", "b95f164cd427474b7ebc228e8d95162d"},
    {"dense_backward_euler", "1b6b0e86c329eae446d59a1e7fab458a"},
    {"ring_of_four", "ad304a617c7fd41525add0a21421f9c9"},
    {"trade_offs_dying_out", "62ec6d1321d37ffb842cdf08470f0910"},
    {"changes_while_it_runs", "054607c7d5928ad7519a05e503e6daad"},
    {"three_thousand", "c6c09a8e6c529b49ca74a4d66c000fdd"},
    {"twenty_thousand", "733c6c34850357d87a6ce2d9ae38953e"},
    {"far_corner", "f5bba82a8a064dbfff81992f98267e52"},
    {"rastrigin", "6f8c8ba85d02b6725b8107a0c1b60946"},
    {"shuffled_fitness", "1ea6208418009bccf45b728ecac2e803"},
    {"weighted_fitness", "69692ebaefda2e75ab517769f0388fad"},
    {"blend", "e3054cfc0155bd87993c0afef5d4c868"},
    {"nsga2", "7de65ff053a76d37eff16da0e0f1c010"},
    {"simulated_binary", "289d5ed70f135cd333d09b1568adb65b"},
    {"scale_mutation", "33c1ab1d2cc139b7d9def6a91647d621"},
    {"crowded_migration", "786103d0bfe4f8d3042345471872260d"},
    {"newtonian_networks", "d1c1626c62a64f926065300db1f00841"},
    {"kinematic_networks", "18b6c4aa2ddd3278ab0454fdb6f6c08e"},
    {"sexual_births", "c15efbe4c1fa93199f9bed82f12f419c"},
    {"predators_and_prey", "2264497befe03a0ab74b7ebbbde7d7f1"},
    {"predators_with_generations", "a259ebef2c7f152c331e8fb01aa08f34"},
    {"births_of_unselected_parents", "3651c413a6113e8f0970a470f7ca0b4e"},
    {"colony_of_thousands", "99be289c418fa90988a699663654d222"},
};

/// A scenario with a set of vector instructions.
class GoldenHash : public testing::TestWithParam<std::tuple<Scenario, base::Instructions>> {
  protected:
    ~GoldenHash() override { base::use_instructions(base::default_instructions()); }
};
std::string name_of_test(const testing::TestParamInfo<GoldenHash::ParamType>& test) {
    return std::string{std::get<Scenario>(test.param).name} + "_" +
           std::string{base::name_of(std::get<base::Instructions>(test.param))};
}
INSTANTIATE_TEST_SUITE_P(All, GoldenHash,
                         testing::Combine(testing::ValuesIn(all()),
                                          testing::Values(base::Instructions::Baseline, base::Instructions::Avx2,
                                                          base::Instructions::Avx512)),
                         name_of_test);

TEST_P(GoldenHash, IsTheSameInEveryBuild) {
    const auto& [scenario, instructions] = GetParam();
    if (instructions > base::widest_instructions()) {
        GTEST_SKIP() << "this processor has no " << base::name_of(instructions);
    }
    base::use_instructions(instructions);
    Play run{scenario};
    base::InlineExecutor executor;
    for (std::uint64_t tick = 1; tick <= scenario.ticks; ++tick) {
        run.advance(executor);
    }
    const auto known = golden_hashes.find(scenario.name);
    EXPECT_EQ(base::to_text(run.world().hash()), known == golden_hashes.end() ? "unknown" : known->second);
}

TEST(GoldenHashes, AreKnownForEveryScenarioAndNoOther) {
    EXPECT_EQ(golden_hashes.size(), all().size());
}

TEST(TheScenarios, UseTheFeaturesTheyAreNamedAfter) {
    base::InlineExecutor executor;
    std::uint64_t limited = 0, deaths = 0, poisoned = 0, clamped = 0, generations = 0, extinct = 0;
    simulation::ColonyStatistics prey, predators;
    const auto add = [](simulation::ColonyStatistics& sum, const simulation::GenerationStatistics& s) {
        if (s.colony) {
            sum.born_count += s.colony->born_count;
            sum.refused_count += s.colony->refused_count;
            sum.without_room_count += s.colony->without_room_count;
            sum.eaten_count += s.colony->eaten_count;
            sum.old_count += s.colony->old_count;
        }
    };
    for (const Scenario& scenario : all()) {
        Play run{scenario};
        for (std::uint64_t tick = 1; tick <= scenario.ticks; ++tick) {
            run.advance(executor);
        }
        for (const auto& generation : run.world().history()) {
            for (const simulation::GenerationStatistics& s : generation) {
                limited += s.speed_limit_count;
                deaths += s.starved_count;
                poisoned += s.poisoned_count;
                clamped += s.clamp_count;
                extinct += s.alive_count == 0;
                ++generations;
                add(prey, s);
                std::ranges::for_each(s.predators, [&](const auto& p) { add(predators, p); });
            }
        }
        EXPECT_GE(run.world().moment().generation, 2u) << scenario.name;
    }
    EXPECT_GT(limited, 0u);
    EXPECT_GT(deaths, 100u);
    EXPECT_GE(poisoned, 5u);
    EXPECT_GT(clamped, 0u);
    EXPECT_GT(extinct, 2u);
    EXPECT_GT(generations, 100u);
    EXPECT_GT(prey.born_count, 1000u);
    EXPECT_GT(prey.refused_count, 0u);
    EXPECT_GT(prey.without_room_count, 0u);
    EXPECT_GT(prey.eaten_count, 100u);
    EXPECT_GT(prey.old_count, 100u);
    EXPECT_GT(predators.born_count, 100u);
    EXPECT_GT(predators.old_count, 10u);
}

} // namespace
} // namespace evod::scenarios
