// The snapshots that the loop takes, with a manual clock: when it takes them, and what they contain.
#include "tests/unit/runtime/loop_with_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace evod::runtime {
namespace {

TEST_F(Loop, TakesNoSnapshotWithoutAViewer) {
    send(create("w"));
    send(simulation::Run{"w", {}});
    live_through(100ms);
    EXPECT_TRUE(snapshots.empty());
}

TEST_F(Loop, SnapshotsComeAtTheRequestedRate) {
    send(create("w"));
    send(simulation::Run{"w", {}});
    loop.pass();
    watch("w", 25);
    loop.pass();
    snapshots.clear();
    live_through(2000ms);
    EXPECT_NEAR(static_cast<double>(snapshots.size()), 50, 1);
    for (std::size_t i = 1; i < snapshots.size(); ++i) {
        EXPECT_LT(snapshots[i - 1]->moment.tick, snapshots[i]->moment.tick);
    }
}

TEST_F(Loop, NewViewersAndChangesGetASnapshotAtOnce) {
    send(create("w"));
    loop.pass();
    watch("w", 0.001);
    loop.pass();
    ASSERT_EQ(snapshots.size(), 1);
    live_through(100ms);
    EXPECT_EQ(snapshots.size(), 1) << "the world is idle";
    watch("w", 0.001, 2);
    loop.pass();
    EXPECT_EQ(snapshots.size(), 2) << "a new viewer";
    send(simulation::RunUntilTick{"w", 3});
    loop.pass();
    ASSERT_EQ(snapshots.size(), 3) << "Run changed it";
    EXPECT_TRUE(snapshots.back()->after_change);
    live_through(100ms);
    ASSERT_EQ(snapshots.size(), 4) << "it reached its goal";
    EXPECT_EQ(snapshots.back()->moment.tick, 3);
    EXPECT_EQ(snapshots.back()->state, simulation::RunState::Paused);
    EXPECT_EQ(snapshots.back()->hash, world().world.hash());
    send(simulation::ResetWorld{"w", {}, {9, 9}});
    loop.pass();
    EXPECT_EQ(snapshots.size(), 5);
    send(simulation::DeleteWorld{"w"});
    send(create("w", 3));
    loop.pass();
    ASSERT_EQ(snapshots.size(), 6) << "a new world of the same name";
    EXPECT_EQ(snapshots.back()->run_id, (simulation::RunId{3, 1}));
}

TEST_F(Loop, OnlySubscribedIslandsAreCopied) {
    auto command = create("w");
    command.parameters.island_count = 5;
    send(command);
    demand.set({{"w", WorldDemand{.rate_hz = 1, .all_islands = false, .islands = {1, 3, 99}, .newcomers = 1}}});
    loop.pass();
    ASSERT_EQ(snapshots.size(), 1);
    ASSERT_EQ(snapshots[0]->islands.size(), 2);
    EXPECT_EQ(snapshots[0]->islands[1].island, 3);
    EXPECT_EQ(snapshots[0]->island_count, 5);
}

TEST_F(Loop, ASnapshotHasEveryLivingOrganismAndItem) {
    auto command = create("w");
    command.parameters.population_size = 200;
    command.parameters.food_count = 40;
    command.parameters.respawn_s = 10;
    command.parameters.health_loss_per_s = 190; // health is 80 to 120
    send(command);
    send(simulation::Run{"w", {}});
    watch("w", 1000);
    std::size_t seen_void = 0, seen_away = 0;
    for (int i = 0; i < 60; ++i) {
        live_through(10ms);
        ASSERT_FALSE(snapshots.empty());
        const IslandSnapshot& snapshot = snapshots.back()->islands[0];
        const simulation::Island& island = world().world.islands()[0];
        ASSERT_EQ(snapshots.back()->hash, world().world.hash());
        std::size_t alive = 0;
        ASSERT_EQ(snapshot.organisms.place_of.size(), 200);
        for (std::uint32_t id = 0; id < 200; ++id) {
            const std::uint32_t place = snapshot.organisms.place_of[id];
            const auto body = island.body_of(id);
            ASSERT_EQ(place != simulation::Island::no_body, body.has_value());
            if (!body) {
                continue;
            }
            ASSERT_LT(place, snapshot.organisms.x.size());
            EXPECT_EQ(snapshot.organisms.x[place], island.bodies().x[*body]);
            EXPECT_EQ(snapshot.organisms.y[place], island.bodies().y[*body]);
            EXPECT_EQ(snapshot.organisms.radius_px[place], island.bodies().radius[*body]);
            EXPECT_EQ(snapshot.organisms.health[place], island.living().health[*body]);
            ++alive;
        }
        EXPECT_EQ(alive, island.alive_count());
        EXPECT_EQ(snapshot.organisms.alive_count, alive);
        EXPECT_EQ(snapshot.food.all.size(), 40);
        EXPECT_EQ(snapshot.food.present_count,
                  std::ranges::count(snapshot.food.all, 0u, &simulation::Items::Item::due_tick));
        EXPECT_EQ(simulation::mean_health(snapshot.organisms.health, snapshot.organisms.alive_count),
                  island.live_statistics().health_mean);
        seen_void += snapshot.organisms.x.size() - alive;
        seen_away += 40 - snapshot.food.present_count;
    }
    EXPECT_GT(seen_void, 0);
    EXPECT_GT(seen_away, 0);
}

TEST_F(Loop, ASnapshotIsImmutableAndItsMemoryReused) {
    send(create("w"));
    send(simulation::Run{"w", {}});
    watch("w", 1000);
    loop.pass();
    const SnapshotPtr kept = snapshots.front();
    const auto place = kept->islands[0].organisms.x;
    snapshots.clear();
    std::set<const void*> used;
    for (int i = 0; i < 100; ++i) {
        live_through(10ms);
        for (const SnapshotPtr& snapshot : snapshots) {
            used.insert(snapshot.get());
        }
        snapshots.clear();
    }
    EXPECT_EQ(kept->islands[0].organisms.x, place);
    EXPECT_LE(used.size(), 2);
}

} // namespace
} // namespace evod::runtime
