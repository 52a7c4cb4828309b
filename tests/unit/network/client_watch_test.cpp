#include "server/network/client_watch.h"

#include <gtest/gtest.h>

namespace evod::network {
namespace {

using namespace std::chrono_literals;
using Silence = ClientWatch::Silence;

constexpr Transport::Progress nothing_taken{.given = 10, .not_taken = 10}, part_taken{.given = 10, .not_taken = 4};

TEST(ClientWatch, AClientThatReceivesNothingIsStalled) {
    ClientWatch watch;
    EXPECT_FALSE(watch.is_stalled(nothing_taken, 1h)) << "the time before the first look does not count";
    EXPECT_FALSE(watch.is_stalled(nothing_taken, stalled_timeout - 1s));
    EXPECT_TRUE(watch.is_stalled(nothing_taken, 1s));
}

TEST(ClientWatch, ProgressAndIdlenessRestartTheTime) {
    for (const std::optional<Transport::Progress>& between : {std::optional{part_taken}, {}}) {
        ClientWatch watch;
        watch.is_stalled(nothing_taken, 0s);
        watch.is_stalled(nothing_taken, stalled_timeout - 1s);
        EXPECT_FALSE(watch.is_stalled(between, 1h));
        EXPECT_FALSE(watch.is_stalled(nothing_taken, 1h));
        EXPECT_FALSE(watch.is_stalled(nothing_taken, stalled_timeout - 1s));
    }
}

TEST(ClientWatch, ASilentClientGetsOnePingAndIsThenClosed) {
    ClientWatch watch;
    watch.begin_read();
    EXPECT_EQ(watch.silence_after(websocket_ping_after - 1s), Silence::Short);
    EXPECT_EQ(watch.silence_after(1s), Silence::PingDue);
    EXPECT_EQ(watch.silence_after(1s), Silence::Short);
    EXPECT_EQ(watch.silence_after(websocket_silence_max - websocket_ping_after - 2s), Silence::Short);
    EXPECT_EQ(watch.silence_after(1s), Silence::TooLong);
}

TEST(ClientWatch, SilenceCountsOnlyDuringARead) {
    ClientWatch watch;
    EXPECT_EQ(watch.silence_after(1h), Silence::Short);
    watch.begin_read();
    EXPECT_EQ(watch.silence_after(websocket_ping_after - 1s), Silence::Short);
    watch.end_read();
    EXPECT_EQ(watch.silence_after(1h), Silence::Short);
    watch.begin_read();
    EXPECT_EQ(watch.silence_after(websocket_ping_after - 1s), Silence::Short);
}

} // namespace
} // namespace evod::network
