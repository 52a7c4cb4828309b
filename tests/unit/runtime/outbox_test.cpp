#include "server/runtime/outbox.h"

#include <gtest/gtest.h>

namespace evod::runtime {
namespace {

SnapshotPtr picture_of(const char* world, std::uint64_t tick, bool after_change = false) {
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
    for (const Delivery& delivery : outbox.take().deliveries) {
        delivery();
    }
    EXPECT_EQ(order, (std::vector{1, 2, 3}));
    EXPECT_TRUE(outbox.take().deliveries.empty());
    outbox.answer([] {});
    EXPECT_EQ(woken, 2);
}

TEST(Outbox, DropsEventsBeyondItsBoundAndCountsThemButNeverAnswers) {
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

TEST(Outbox, KeepsTheNewestPictureOfEachWorld) {
    Outbox outbox{[] {}};
    outbox.picture(picture_of("a", 1, true));
    outbox.picture(picture_of("b", 1));
    outbox.picture(picture_of("a", 2));
    outbox.picture(picture_of("a", 3));
    const auto pictures = outbox.take().pictures;
    ASSERT_EQ(pictures.size(), 2);
    EXPECT_EQ(pictures[0].snapshot->moment.tick, 3);
    EXPECT_EQ(pictures[0].replaced_count, 2);
    EXPECT_TRUE(pictures[0].after_change) << "one that it replaced showed a change";
    EXPECT_EQ(pictures[1].replaced_count, 0);
    EXPECT_FALSE(pictures[1].after_change);
}

} // namespace
} // namespace evod::runtime
