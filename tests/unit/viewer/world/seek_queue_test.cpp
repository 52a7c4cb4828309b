#include "client/viewer/world/seek_queue.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

evod::v1::RunMoment tick(std::uint64_t tick) {
    evod::v1::RunMoment moment;
    moment.set_tick(tick);
    return moment;
}

TEST(SeekQueue, SendsTheNewestWaitingSeekAfterAnAnswer) {
    SeekQueue seeks;
    EXPECT_EQ(seeks.target(), nullptr);
    ASSERT_TRUE(seeks.add(tick(10)));
    EXPECT_FALSE(seeks.add(tick(20)));
    EXPECT_FALSE(seeks.add(tick(30)));
    ASSERT_NE(seeks.target(), nullptr);
    EXPECT_EQ(seeks.target()->tick(), 30u);
    const auto next = seeks.answered();
    ASSERT_TRUE(next);
    EXPECT_EQ(next->tick(), 30u);
    EXPECT_FALSE(seeks.answered());
    EXPECT_EQ(seeks.target(), nullptr);
    EXPECT_EQ(seeks.add(tick(40))->tick(), 40u);
}

TEST(SeekQueue, SendsNothingAfterClear) {
    SeekQueue seeks;
    seeks.add(tick(10));
    seeks.add(tick(20));
    seeks.clear();
    EXPECT_EQ(seeks.target(), nullptr);
    EXPECT_EQ(seeks.add(tick(30))->tick(), 30u);
}

} // namespace
} // namespace evod::viewer
