#include "server/runtime/outbox.h"

#include <gtest/gtest.h>

namespace evod::runtime {
namespace {

SnapshotPtr snapshot_of(const char* world, std::uint64_t tick, bool after_change = false) {
    auto snapshot = std::make_shared<Snapshot>();
    snapshot->world = world;
    snapshot->moment.tick = tick;
    snapshot->after_change = after_change;
    return snapshot;
}

TEST(Outbox, KeepsAllDeliveriesInOneOrder) {
    int woken = 0;
    Outbox outbox{[&] { ++woken; }};
    v1::Event event;
    event.set_world("a");
    outbox.damaged({.name = "w", .run_id = {}, .reason = "cut off"});
    outbox.event(event);
    outbox.storage({.storage = {simulation::StorageState::Failing, "full"}, .world = "b"});
    EXPECT_EQ(woken, 1) << "once until it is taken";
    outbox.reply(CommandDone{.mail = {}, .outcome = simulation::Applied{}, .frame = "answer"});
    const auto taken = outbox.take().deliveries;
    ASSERT_EQ(taken.size(), 4);
    EXPECT_EQ(std::get<simulation::DamagedWorld>(taken[0]).reason, "cut off");
    EXPECT_EQ(std::get<v1::Event>(taken[1]).world(), "a");
    EXPECT_EQ(std::get<StorageChanged>(taken[2]).storage.reason, "full");
    EXPECT_EQ(std::get<CommandDone>(std::get<Reply>(taken[3])).frame, "answer");
    EXPECT_TRUE(outbox.take().deliveries.empty());
    outbox.reply(Pong{});
    EXPECT_EQ(woken, 2);
}

TEST(Outbox, DropsAndCountsExcessEventsButNothingElse) {
    Outbox outbox{[] {}, 2};
    for (int i = 0; i < 5; ++i) {
        outbox.event({});
        outbox.reply(Pong{});
        outbox.storage({.storage = {}});
        outbox.damaged({.name = "w", .run_id = {}, .reason = {}});
    }
    EXPECT_EQ(outbox.fill().events, 2);
    const auto taken = outbox.take();
    EXPECT_EQ(taken.deliveries.size(), 2 + 3 * 5);
    EXPECT_EQ(taken.dropped_events, (std::map<std::string, std::uint64_t>{{"", 3}}));
    outbox.event({});
    EXPECT_TRUE(outbox.take().dropped_events.empty());
}

TEST(Outbox, EventsOfReplaysLeaveHalfToLiveWorlds) {
    Outbox outbox{[] {}, 8};
    for (int i = 0; i < 5; ++i) {
        outbox.event({}, "eve");
        outbox.event({}, "bob");
    }
    EXPECT_EQ(outbox.fill().events, 4) << "half, of which each user has half";
    for (int i = 0; i < 5; ++i) {
        outbox.event({});
    }
    EXPECT_EQ(outbox.fill().events, 8);
    EXPECT_EQ(outbox.take().dropped_events, (std::map<std::string, std::uint64_t>{{"", 1}, {"bob", 3}, {"eve", 3}}));
    outbox.event({}, "eve");
    EXPECT_EQ(outbox.fill().events, 1);
}

TEST(Outbox, KeepsTheNewestSnapshotOfEachWorld) {
    Outbox outbox{[] {}};
    outbox.snapshot(snapshot_of("a", 1, true));
    outbox.snapshot(snapshot_of("b", 1));
    outbox.snapshot(snapshot_of("a", 2));
    outbox.snapshot(snapshot_of("a", 3));
    const auto snapshots = outbox.take().snapshots;
    ASSERT_EQ(snapshots.size(), 2);
    EXPECT_EQ(snapshots[0].snapshot->moment.tick, 3);
    EXPECT_EQ(snapshots[0].replaced_count, 2);
    EXPECT_TRUE(snapshots[0].after_change) << "a replaced snapshot showed a change";
    EXPECT_EQ(snapshots[1].replaced_count, 0);
    EXPECT_FALSE(snapshots[1].after_change);
}

} // namespace
} // namespace evod::runtime
