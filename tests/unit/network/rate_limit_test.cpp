#include "server/network/rate_limit.h"

#include <gtest/gtest.h>

namespace evod::network {
namespace {

using namespace std::chrono_literals;

class RateLimitTest : public testing::Test {
  protected:
    int take_all() {
        int taken = 0;
        while (bucket.take(1, now)) {
            ++taken;
        }
        return taken;
    }
    runtime::Clock::time_point now{1000s};
    RateLimit bucket{100, 20, now};
};

TEST_F(RateLimitTest, ABurstIsAvailableAtOnce) {
    EXPECT_EQ(take_all(), 20);
}

TEST_F(RateLimitTest, TokensArriveAtTheirRateUpToTheCapacity) {
    take_all();
    now += 50ms;
    EXPECT_EQ(take_all(), 5);
    now += 5ms;
    EXPECT_EQ(take_all(), 0) << "half a token";
    now += 5ms;
    EXPECT_EQ(take_all(), 1);
    now += 1h;
    EXPECT_EQ(take_all(), 20);
}

TEST_F(RateLimitTest, ASenderBelowTheRateNeverWaits) {
    take_all();
    for (int i = 0; i < 1000; ++i) {
        now += 10ms;
        EXPECT_TRUE(bucket.take(1, now)) << i;
    }
}

TEST_F(RateLimitTest, TakingMoreThanTheCapacityLeavesADebt) {
    EXPECT_TRUE(bucket.take(50, now)) << "a whole burst is there";
    now += 300ms;
    EXPECT_FALSE(bucket.take(1, now)) << "30 are still to be paid for";
    now += 10ms;
    EXPECT_TRUE(bucket.take(1, now));
    bucket.charge(10);
    now += 100ms;
    EXPECT_FALSE(bucket.take(1, now));
    now += 10ms;
    EXPECT_FALSE(bucket.take(2, now)) << "nothing is taken where there are too few";
    EXPECT_TRUE(bucket.take(1, now));
}

TEST_F(RateLimitTest, WaitingForTheReportedTimeIsEnough) {
    take_all();
    EXPECT_EQ(bucket.time_for(10), 100ms);
    now += bucket.time_for(10);
    EXPECT_EQ(take_all(), 10);
}

} // namespace
} // namespace evod::network
