#include "server/base/stop_check.h"

#include <gtest/gtest.h>

namespace evod::base {
namespace {

TEST(StopCheck, WithoutAFunctionItNeverStops) {
    EXPECT_FALSE(StopCheck{}());
    bool is_stopped = false;
    const StopCheck check{[&] { return is_stopped; }};
    EXPECT_FALSE(check());
    is_stopped = true;
    EXPECT_TRUE(check());
}

} // namespace
} // namespace evod::base
