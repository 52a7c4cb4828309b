// A command that finds too little memory for a new world changes nothing, whichever allocation fails.
#include "server/base/inline_executor.h"
#include "server/base/within_memory.h"
#include "server/simulation/laboratory.h"
#include "tests/unit/simulation/counted_allocations.h"

#include <gtest/gtest.h>

namespace evod::simulation {
namespace {

class NoMemory : public testing::Test {
  protected:
    NoMemory() {
        parameters.population_size = 6;
        parameters.island_count = 2;
        parameters.generation_s = 2;
        EXPECT_TRUE(
            laboratory.apply(CreateWorld{.name = "w", .parameters = parameters, .seed = {7}, .run_id = {1, 2}}));
        while (world().moment().generation < 3 || world().moment().generation_tick < 10) {
            laboratory.advance(**laboratory.find("w"), executor);
        }
        EXPECT_TRUE(laboratory.apply(
            SetParameters{.world = "w", .assignments = {{"food_health", 7.0}}, .expected_revision = {}}));
    }

    const World& world() { return (*laboratory.find("w"))->world; }

    /// Lets every allocation of the command fail, one after another, until it succeeds.
    Applied expect_nothing_changes_until_done(const Command& command) {
        const base::StateHash hash = world().hash();
        const Moment moment = world().moment();
        const std::uint64_t revision = world().parameters().revision;
        for (std::size_t failing = 1;; ++failing) {
            tests::allocations_until_failure = failing;
            const auto applied = base::within_memory([&] { return laboratory.apply(command); });
            tests::allocations_until_failure = 0;
            if (applied) {
                EXPECT_GT(failing, 20u);
                return *applied;
            }
            EXPECT_EQ(applied.error().code, base::RefusalCode::ResourceExhausted);
            EXPECT_EQ(laboratory.entries().size(), 1u);
            EXPECT_EQ((*laboratory.find("w"))->run_id, (RunId{1, 2}));
            EXPECT_EQ(world().hash(), hash);
            EXPECT_EQ(world().moment().tick, moment.tick);
            EXPECT_EQ(world().history().size(), 2u);
            EXPECT_EQ(world().parameters().revision, revision);
            if (HasFailure()) {
                ADD_FAILURE() << "allocation " << failing;
                return {};
            }
        }
    }

    base::InlineExecutor executor;
    parameters::Parameters parameters;
    Laboratory laboratory;
};

TEST_F(NoMemory, ChangesNothingForANewWorld) {
    const CreateWorld create{
        .name = "a world with a long name", .parameters = parameters, .seed = {9}, .run_id = {3, 4}};
    expect_nothing_changes_until_done(create);
    ASSERT_EQ(laboratory.entries().size(), 2u);
    EXPECT_EQ(laboratory.entries()[1]->world.hash(), (World{parameters, {9}}.hash()));
}

TEST_F(NoMemory, ChangesNothingForAReset) {
    const std::uint64_t revision = world().parameters().revision;
    const parameters::Parameters requested = world().parameters().requested.values;
    expect_nothing_changes_until_done(ResetWorld{"w", base::Seed{9}, {3, 4}});
    EXPECT_EQ(world().hash(), (World{requested, {9}}.hash()));
    EXPECT_EQ(world().moment().tick, 0u);
    EXPECT_EQ(world().parameters().revision, revision);
    EXPECT_EQ(world().opening().parameters.revision, revision);
    EXPECT_TRUE(world().history().empty());
}

TEST_F(NoMemory, ChangesNothingForAFork) {
    const base::StateHash hash = world().hash();
    expect_nothing_changes_until_done(ForkWorld{"w", "a fork with a long name", {}, {3, 4}});
    ASSERT_EQ(laboratory.entries().size(), 2u);
    EXPECT_EQ(laboratory.entries()[1]->world.hash(), hash);
}

} // namespace
} // namespace evod::simulation
