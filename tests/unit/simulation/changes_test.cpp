#include "server/simulation/changes.h"

#include <gtest/gtest.h>

namespace evod::simulation {
namespace {

using parameters::RequestedParameters;

const base::Actor alice = base::client_actor("alice", "evoctl", "127.0.0.1:5000");

TEST(Changes, ListTheParametersThatDiffer) {
    parameters::Parameters before, after;
    after.mutation_chance = 0.2;
    after.food_count = 7;
    Changes changes;
    changes.add(20, alice, RequestedParameters{before}, RequestedParameters{after});
    changes.add(21, {}, RequestedParameters{after}, RequestedParameters{after});
    ASSERT_EQ(changes.all().size(), 1u) << "nothing differs in the second change";
    EXPECT_EQ(changes.all()[0], (Change{.generation = 20,
                                        .by = alice,
                                        .values = {{"food_count", before.food_count, 7u},
                                                   {"mutation_chance", before.mutation_chance, 0.2}}}));
    changes.clear();
    EXPECT_TRUE(changes.all().empty());
}

TEST(Changes, OmitParametersThatWaitForAReset) {
    parameters::Parameters before, after;
    after.island_count = 4;
    Changes changes;
    changes.add(1, alice, RequestedParameters{before}, RequestedParameters{after});
    EXPECT_TRUE(changes.all().empty());
}

TEST(Changes, DropTheOldestAboveTheLimit) {
    parameters::Parameters before, after;
    after.mutation_chance = 0.2;
    after.food_count = 7;
    Changes changes;
    for (std::uint64_t generation = 1; generation <= Changes::values_kept; ++generation) {
        changes.add(generation, alice, RequestedParameters{before}, RequestedParameters{after});
    }
    EXPECT_EQ(changes.all().size(), Changes::values_kept / 2) << "two values each";
    EXPECT_EQ(changes.all().back().generation, Changes::values_kept);
}

} // namespace
} // namespace evod::simulation
