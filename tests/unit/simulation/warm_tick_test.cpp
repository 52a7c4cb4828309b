// A tick allocates no memory once its working memory has grown.
#include "server/base/inline_executor.h"
#include "server/parameters/experiment.h"
#include "server/simulation/world.h"
#include "tests/unit/simulation/counted_allocations.h"

#include <gtest/gtest.h>

namespace evod::simulation {
namespace {

class AWarmTick : public testing::TestWithParam<const char*> {};

TEST_P(AWarmTick, AllocatesNothing) {
    World world{parameters::parse_experiment(GetParam()).value().parameters, base::Seed{1}};
    base::InlineExecutor executor;
    // A generation, its turnover, and part of the next: all working memory has reached its full size.
    while (world.moment().generation < 2 || world.moment().generation_tick < 300) {
        world.advance_tick(executor);
    }
    for (int tick = 0; tick < 300; ++tick) {
        const std::size_t before = tests::allocations;
        world.advance_tick(executor);
        ASSERT_EQ(tests::allocations, before) << "in tick " << world.moment().generation_tick;
    }
    ASSERT_EQ(world.moment().generation, 2u);
}

INSTANTIATE_TEST_SUITE_P(
    Worlds, AWarmTick,
    testing::Values(
        R"({})",
        R"({"population_size": 5000, "scale_with_population": true, "reference_population": 50, "generation_s": 15})",
        R"({"crate_count": 12, "obstacle_count": 12, "integrator": "explicit_euler", "respawn_s": 2})",
        R"({"island_count": 4, "generation_s": 15})"));

} // namespace
} // namespace evod::simulation
