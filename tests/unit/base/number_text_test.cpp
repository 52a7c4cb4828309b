#include "server/base/number_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace evod::base {
namespace {

TEST(NumberText, IsTheShortestThatParsesBackTheSame) {
    EXPECT_EQ(number_text(0.1), "0.1");
    EXPECT_EQ(number_text(0), "0");
    EXPECT_EQ(number_text(-2.5), "-2.5");
    EXPECT_EQ(number_text(1e20), "1e+20");
    EXPECT_EQ(std::stod(number_text(1.0 / 3)), 1.0 / 3);
    EXPECT_EQ(std::stod(number_text(std::numeric_limits<double>::denorm_min() * 1e300)),
              std::numeric_limits<double>::denorm_min() * 1e300);
}

TEST(NumberText, NamesWhatIsNoFiniteNumber) {
    EXPECT_EQ(number_text(std::nan("")), "nan");
    EXPECT_EQ(number_text(-std::numeric_limits<double>::infinity()), "-inf");
}

} // namespace
} // namespace evod::base
