#include "server/commands/progress_line.h"

#include <gtest/gtest.h>

namespace evod::commands {
namespace {

TEST(TimeLeft, AssumesAConstantRate) {
    EXPECT_EQ(time_left(0.25, 30), "90 s left");
    EXPECT_EQ(time_left(1, 1000), "0 s left");
}

TEST(TimeLeft, HasSecondsMinutesOrHours) {
    EXPECT_EQ(time_left(0.5, 119), "119 s left");
    EXPECT_EQ(time_left(0.5, 120), "2 min left");
    EXPECT_EQ(time_left(0.5, 119 * 60), "119 min left");
    EXPECT_EQ(time_left(0.5, 2 * 3600 + 5 * 60), "2 h 05 min left");
}

} // namespace
} // namespace evod::commands
