#include "server/base/elementary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace evod::base {
namespace {

TEST(Elementary, SineAndCosineAgreeWithTheLibraryOverManyTurns) {
    for (int i = -40000; i <= 40000; ++i) {
        const double turns = i / 8192.0 * 1.25;
        const long double angle = 2 * 3.14159265358979323846264338327950288L * static_cast<long double>(turns);
        ASSERT_NEAR(sin_turns(turns), static_cast<double>(std::sin(angle)), 1e-15) << turns;
        ASSERT_NEAR(cos_turns(turns), static_cast<double>(std::cos(angle)), 1e-15) << turns;
    }
}

TEST(Elementary, QuarterTurnsAreExact) {
    EXPECT_EQ(cos_turns(0), 1);
    EXPECT_EQ(sin_turns(0), 0);
    EXPECT_EQ(cos_turns(0.25), 0);
    EXPECT_EQ(sin_turns(0.25), 1);
    EXPECT_EQ(cos_turns(0.5), -1);
    EXPECT_EQ(sin_turns(-0.25), -1);
}

TEST(Elementary, ExponentialAndLogarithmAgreeWithTheLibrary) {
    for (double x = -699.5; x < 700; x += 0.37) {
        ASSERT_NEAR(exp(x) / std::exp(x), 1, 1e-15) << x;
    }
    EXPECT_EQ(exp(0), 1);
    EXPECT_EQ(exp(-1000), 0);
    for (double x = 1e-300; x < 1e300; x *= 1.37) {
        ASSERT_NEAR(log(x), std::log(x), 1e-15 * (1 + std::abs(std::log(x)))) << x;
    }
    EXPECT_EQ(log(1), 0);
}

TEST(Elementary, PowersAgreeWithTheLibraryAndHaveStatedEdges) {
    for (double x = 0.01; x < 50; x *= 1.3) {
        for (double y = -8; y <= 8; y += 0.7) {
            ASSERT_NEAR(pow(x, y) / std::pow(x, y), 1, 1e-15 * (1 + std::abs(y * std::log(x)))) << x << '^' << y;
        }
    }
    EXPECT_EQ(pow(0, 2), 0);
    EXPECT_EQ(pow(0, 0), 1);
}

TEST(Elementary, DirectionsHaveLengthOneAndTheAngleOfTheirWord) {
    for (std::uint64_t word = 0; word < 1ull << 32; word += 65'521) {
        const Direction d = direction(static_cast<unsigned>(word));
        const double angle = 2 * pi * static_cast<double>(word) / 4294967296.0;
        ASSERT_NEAR(d.x, std::cos(angle), 3e-7) << word;
        ASSERT_NEAR(d.y, std::sin(angle), 3e-7) << word;
        ASSERT_NEAR(std::hypot(d.x, d.y), 1, 3e-7) << word;
    }
}

} // namespace
} // namespace evod::base
