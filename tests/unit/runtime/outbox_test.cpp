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

TEST(Outbox, KeepsAnswersAndEventsInOneOrder) {
    int woken = 0;
    Outbox outbox{[&] { ++woken; }};
    std::vector<int> order;
    outbox.answer([&] { order.push_back(1); });
    outbox.event([&] { order.push_back(2); });
    outbox.answer([&] { order.push_back(3); });
    EXPECT_EQ(woken, 1) << "once until it is taken";
    outbox.reply(CommandDone{.mail = {}, .outcome = simulation::Applied{}, .frame = "answer"});
    const auto taken = outbox.take().deliveries;
    ASSERT_EQ(taken.size(), 4);
    for (std::size_t i = 0; i < 3; ++i) {
        std::get<Call>(taken[i])();
    }
    EXPECT_EQ(order, (std::vector{1, 2, 3}));
    EXPECT_EQ(std::get<CommandDone>(std::get<Reply>(taken[3])).frame, "answer");
    EXPECT_TRUE(outbox.take().deliveries.empty());
    outbox.answer([] {});
    EXPECT_EQ(woken, 2);
}

TEST(Outbox, DropsAndCountsExcessEventsButNoAnswers) {
    Outbox outbox{[] {}, 2};
    for (int i = 0; i < 5; ++i) {
        outbox.event([] {});
        outbox.answer([] {});
    }
    const auto taken = outbox.take();
    EXPECT_EQ(taken.deliveries.size(), 2 + 5);
    EXPECT_EQ(taken.dropped_events, 3);
    outbox.event([] {});
    EXPECT_EQ(outbox.take().dropped_events, 0);
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
