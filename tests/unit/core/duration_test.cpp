#include "client/core/duration.h"

#include <gtest/gtest.h>

#include <cmath>

namespace evod::core {
namespace {

TEST(Durations, HaveTheirUnit) {
    EXPECT_EQ(duration(0), "0.0 s");
    EXPECT_EQ(duration(59.96), "60.0 s");
    EXPECT_EQ(duration(245), "4:05 min");
    EXPECT_EQ(duration(119.9999), "2:00 min") << "a sum of ticks is seldom whole";
    EXPECT_EQ(duration(7200), "2:00:00 h");
    EXPECT_EQ(duration(std::nan("")), "nan s");
}

} // namespace
} // namespace evod::core
