// Log limit: each user has a rate of log lines of its own, and lines that were left out are counted.
#include "server/network/log_limit.h"

#include "tests/support/manual_clock.h"

#include <gtest/gtest.h>

namespace evod::network {
namespace {

constexpr auto burst = static_cast<int>(session_lines_burst);

TEST(LogLimit, LinesAreLeftOutAndCounted) {
    support::ManualClock clock;
    LogLimit limit;
    for (int line = 0; line < burst; ++line) {
        EXPECT_EQ(limit.take("eve", clock.now()), 0u);
    }
    for (int line = 0; line < 5; ++line) {
        EXPECT_EQ(limit.take("eve", clock.now()), std::nullopt);
    }
    clock.advance(std::chrono::seconds{1});
    EXPECT_EQ(limit.take("eve", clock.now()), 5u);
    EXPECT_EQ(limit.take("eve", clock.now()), std::nullopt);
    clock.advance(std::chrono::seconds{1});
    EXPECT_EQ(limit.take("eve", clock.now()), 1u);
}

TEST(LogLimit, AUserDoesNotHideAnother) {
    support::ManualClock clock;
    LogLimit limit;
    for (int line = 0; line < 10 * burst; ++line) {
        limit.take("eve", clock.now());
    }
    EXPECT_EQ(limit.take("ada", clock.now()), 0u);
}

TEST(LogLimit, TheLeastRecentUserIsForgotten) {
    support::ManualClock clock;
    LogLimit limit;
    const auto use_up = [&](const std::string& user) {
        while (limit.take(user, clock.now())) {
        }
        clock.advance(std::chrono::nanoseconds{1});
    };
    use_up("first");
    use_up("second");
    for (std::size_t number = 2; number < log_users_max; ++number) {
        limit.take(std::to_string(number), clock.now());
        clock.advance(std::chrono::nanoseconds{1});
    }
    limit.take("first", clock.now());
    EXPECT_EQ(limit.take("one more", clock.now()), 0u);
    EXPECT_EQ(limit.take("first", clock.now()), std::nullopt);
    EXPECT_EQ(limit.take("second", clock.now()), 0u) << "it is new";
}

} // namespace
} // namespace evod::network
