// Large frames: the time that a user's frames take is followed by four times as long without one, for this user only.
#include "server/network/large_frames.h"

#include "tests/support/manual_clock.h"

#include <gtest/gtest.h>

namespace evod::network {
namespace {

using std::chrono::milliseconds;

TEST(LargeFrames, AUserWaitsFourTimesAsLong) {
    support::ManualClock clock;
    LargeFrames frames;
    EXPECT_LE(frames.earliest("eve"), clock.now());
    frames.charge("eve", clock.now(), milliseconds{30});
    EXPECT_EQ(frames.earliest("eve"), clock.now() + milliseconds{120});
    EXPECT_LE(frames.earliest("ada"), clock.now());
    clock.advance(milliseconds{120});
    EXPECT_LE(frames.earliest("eve"), clock.now());
}

TEST(LargeFrames, ASlowMachineIsNotChargedForEver) {
    support::ManualClock clock;
    LargeFrames frames;
    frames.charge("eve", clock.now(), std::chrono::hours{1});
    EXPECT_EQ(frames.earliest("eve"), clock.now() + std::chrono::seconds{4});
    frames.charge("ada", clock.now(), milliseconds{-1});
    EXPECT_LE(frames.earliest("ada"), clock.now());
}

TEST(LargeFrames, ContainSmallOnesNot) {
    EXPECT_FALSE(LargeFrames::contains(4096));
    EXPECT_TRUE(LargeFrames::contains(4097));
}

} // namespace
} // namespace evod::network
