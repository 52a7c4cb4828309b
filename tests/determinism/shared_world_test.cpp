// A world has the same state, statistics and events no matter how many processes share its islands, and how many ticks
// they simulate before they exchange results.

#include "server/base/inline_executor.h"
#include "server/parameters/experiment.h"
#include "server/simulation/shared/orders.h"
#include "tests/determinism/scenarios.h"
#include "tests/support/shared_worlds.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace evod::scenarios {
namespace {

using simulation::World;

/// Creates the world of a scenario. Its changes are planned for the ticks before which Play makes them.
World world_of(const Scenario& scenario, simulation::IslandsMaker* maker) {
    World world{parameters_of(scenario.experiment), scenario.seed, {}, {}, maker};
    for (const Change& change : scenario.changes) {
        const parameters::Parameters values = parameters_of(change.parameters);
        parameters::PlannedChange planned{
            .at = {.generation = {}, .tick = change.tick - 1}, .assignments = {}, .by = {}};
        for (const parameters::ParameterDescription& description : parameters::parameter_registry()) {
            if (change.parameters.find("\"" + std::string{description.name} + "\":") != std::string_view::npos) {
                planned.assignments.push_back({std::string{description.name}, description.get(values)});
            }
        }
        world.plan(planned);
    }
    return world;
}

std::string statistics_of(const World& world) {
    base::Packer packer;
    for (const simulation::GenerationRows& generation : world.history()) {
        for (const simulation::GenerationStatistics& island : generation) {
            packer.add(island);
        }
    }
    return packer.take();
}

/// What an observer of a run sees, at the ticks that the slices end with.
struct Seen {
    std::map<std::uint64_t, base::StateHash> hashes;
    std::map<std::uint64_t, std::uint64_t> alive;
    std::string statistics;
    std::size_t extinctions = 0, events = 0;
};

/// Advances the world to `ticks`, at most `slice` ticks at a time.
Seen advance(World& world, std::uint64_t ticks, std::uint64_t slice, base::Executor& executor) {
    Seen seen;
    while (world.moment().tick < ticks && world.outcome() == evolution::Outcome::Running) {
        world.advance(std::min(world.moment().tick + slice, ticks), executor);
        seen.hashes[world.moment().tick] = world.hash();
        seen.alive[world.moment().tick] = world.alive_count();
        for (const simulation::EventKind& event : world.take_events()) {
            ++seen.events;
            seen.extinctions += std::holds_alternative<simulation::Extinction>(event);
        }
    }
    seen.statistics = statistics_of(world);
    return seen;
}

/// Expects that `shared` equals `alone` at every tick at which the slices of `shared` ended.
void expect_equal(const Seen& shared, const Seen& alone) {
    for (const auto& [tick, hash] : shared.hashes) {
        ASSERT_EQ(hash, alone.hashes.at(tick)) << "states differ after tick " << tick;
        ASSERT_EQ(shared.alive.at(tick), alone.alive.at(tick)) << "after tick " << tick;
    }
    EXPECT_EQ(shared.hashes.rbegin()->first, alone.hashes.rbegin()->first);
    EXPECT_TRUE(shared.statistics == alone.statistics);
    EXPECT_EQ(shared.extinctions, alone.extinctions);
    EXPECT_EQ(shared.events, alone.events);
}

void compare(const Scenario& scenario, std::uint32_t processes, std::uint64_t slice, std::size_t threads) {
    base::InlineExecutor one;
    World reference = world_of(scenario, nullptr);
    const Seen alone = advance(reference, scenario.ticks, 1, one);
    support::share_worlds(processes, threads, [&](simulation::IslandsMaker& maker, base::Executor& executor) {
        World world = world_of(scenario, &maker);
        ASSERT_TRUE(world.is_shared());
        expect_equal(advance(world, scenario.ticks, slice, executor), alone);
        EXPECT_EQ(world.bred().founders, reference.bred().founders);
        EXPECT_EQ(world.bred().openings, reference.bred().openings);
        EXPECT_EQ(world.state(executor).islands, reference.state(one).islands);
        for (std::size_t i = 0; i < world.island_count(); ++i) {
            EXPECT_EQ(world.island(i).hash(), reference.island(i).hash());
        }
    });
}

struct Sharing {
    Scenario scenario;
    std::uint32_t processes;
    std::uint64_t slice;
};

/// Every scenario with several islands, in up to 4 processes.
std::vector<Sharing> sharings() {
    std::vector<Sharing> some;
    for (const Scenario& scenario : all()) {
        for (std::uint32_t processes = 2; processes <= parameters_of(scenario.experiment).island_count; ++processes) {
            for (const std::uint64_t slice : {1, 7, 60, 1'000'000}) {
                some.push_back({scenario, processes, slice});
            }
        }
    }
    return some;
}

class SharedWorld : public testing::TestWithParam<Sharing> {};

TEST_P(SharedWorld, EqualsTheSameWorldInOneProcess) {
    const auto& [scenario, processes, slice] = GetParam();
    compare(scenario, processes, slice, 1);
}

std::string name_of_sharing(const testing::TestParamInfo<Sharing>& test) {
    const Sharing& sharing = test.param;
    return std::string{sharing.scenario.name} + "_in_" + std::to_string(sharing.processes) + "_by_" +
           std::to_string(sharing.slice);
}
INSTANTIATE_TEST_SUITE_P(Processes, SharedWorld, testing::ValuesIn(sharings()), name_of_sharing);

TEST(SharedWorlds, DoNotDependOnThreads) {
    for (const std::size_t threads : {1, 2, 3}) {
        compare(sharings().front().scenario, 2, 60, threads);
    }
}

/// Eight islands on which all organisms die, at different ticks, before or after changes that are planned meanwhile.
TEST(SharedWorlds, EndAGenerationWhenAllOrganismsDied) {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        Scenario scenario{.name = "dying",
                          .experiment = R"({"island_count": 8, "population_size": 12, "health_loss_per_s": 60,
                                            "respawn": false, "migration": "fully_connected", "migration_epoch": 1,
                                            "emigrants": "random", "immigrants_replace": "random"})",
                          .seed = base::Seed{seed},
                          .ticks = 900,
                          .changes = {}};
        for (std::uint64_t tick = 20 * seed; tick < scenario.ticks; tick += 37 + seed) {
            scenario.changes.push_back({tick, tick % 2 == 0 ? R"({"health_loss_per_s": 45})" : R"({"tick_s": 0.02})"});
            scenario.changes.push_back({tick + 5, R"({"health_loss_per_s": 70, "tick_s": 0.016})"});
        }
        for (const std::uint32_t processes : {2, 5, 8}) {
            compare(scenario, processes, 1 + 50 * (seed % 3), 1);
        }
    }
}

/// On some islands, everything dies.
TEST(SharedWorlds, MayBeColonies) {
    constexpr const char* kinds[] = {
        R"({"reproduction": "births", "births": "asexual", "lifespan_s": 5, "birth_cost": 5)",
        R"({"reproduction": "births", "births": "asexual", "predator_count": 3, "predator_from": 2, "handling_s": 1,
            "shuffle_births": true)",
        R"({"predator_count": 5, "predator_from": 2, "handling_s": 1, "predator_elite_count": 1)"};
    for (const char* kind : kinds) {
        const std::string experiment = std::string{kind} + R"(, "island_count": 4, "population_size": 12,
            "generation_s": 2, "food_count": 60, "food_health": 60, "migration": "ring", "migration_epoch": 2})";
        const Scenario scenario{
            .name = "colony", .experiment = experiment, .seed = base::Seed{3}, .ticks = 500, .changes = {}};
        for (const std::uint32_t processes : {2, 4}) {
            compare(scenario, processes, 47, 1);
        }
    }
}

} // namespace
} // namespace evod::scenarios
