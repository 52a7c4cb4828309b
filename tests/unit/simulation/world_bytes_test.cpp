#include "server/simulation/world_bytes.h"

#include "server/base/inline_executor.h"

#include <gtest/gtest.h>

namespace evod::simulation {
namespace {

// network/memory_account_test.cpp compares the estimate with the memory that is allocated.

TEST(WorldBytes, GrowWithOrganismsAndIslands) {
    parameters::Parameters few, many, islands;
    many.population_size = 10 * few.population_size;
    islands.island_count = 10;
    const auto bytes = [](const parameters::Parameters& parameters) {
        return estimated_bytes(World{parameters, base::Seed{1}});
    };
    EXPECT_GT(bytes(many), bytes(few) + 9 * 100 * few.population_size);
    EXPECT_GT(bytes(islands), 5 * bytes(few));
}

TEST(WorldBytes, GrowWithTheHistory) {
    parameters::Parameters parameters;
    parameters.fitness = parameters::FitnessFunction::GeneSum;
    World world{parameters, base::Seed{1}};
    base::InlineExecutor executor;
    const auto grow = [&] {
        const std::size_t before = estimated_bytes(world), generations = world.history().size();
        while (world.history().size() == generations) {
            world.advance_tick(executor);
        }
        return estimated_bytes(world) - before;
    };
    grow();
    grow();
    EXPECT_GT(grow(), sizeof(GenerationStatistics));
}

} // namespace
} // namespace evod::simulation
