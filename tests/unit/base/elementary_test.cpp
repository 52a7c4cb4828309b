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

TEST(Elementary, HyperbolicTangentHasItsStatedError) {
    for (double x = 1e-30; x < 1e3; x *= 1.0007) {
        const float number = static_cast<float>(x);
        const auto exact = std::tanh(static_cast<long double>(number));
        const float value = tanh(number);
        ASSERT_NEAR(static_cast<double>(value / exact), 1, 3e-7) << number;
        ASSERT_LE(value, 1) << number;
        ASSERT_EQ(tanh(-number), -value) << number;
    }
    EXPECT_EQ(tanh(0), 0);
    EXPECT_NEAR(tanh(1e30f), 1, 3e-7);
}

TEST(Elementary, AnglesHaveTheirStatedErrorInEveryDirection) {
    constexpr long double exact_pi = 3.14159265358979323846264338327950288L;
    for (int i = 0; i < 200'000; ++i) {
        const double turns = (i + 0.5) / 200'000, length = 0.01 + i % 977;
        const auto x = static_cast<float>(length * cos_turns(turns)), y = static_cast<float>(length * sin_turns(turns));
        const long double exact = std::atan2(static_cast<long double>(y), static_cast<long double>(x)) / exact_pi;
        ASSERT_NEAR(static_cast<double>(half_turns(x, y) / exact), 1, 3e-7) << x << ", " << y;
    }
    EXPECT_EQ(half_turns(0, 0), 0);
    EXPECT_EQ(half_turns(2, 0), 0);
    EXPECT_EQ(half_turns(-2, 0), 1);
    EXPECT_EQ(half_turns(0, 3), 0.5f);
    EXPECT_EQ(half_turns(0, -3), -0.5f);
    EXPECT_NEAR(half_turns(-1, 1e-30f), 1, 1e-7);
    EXPECT_NEAR(half_turns(-1, -1e-30f), -1, 1e-7);
}

TEST(Elementary, DirectionsOfRadiansHaveTheirStatedError) {
    for (int i = -40'000; i <= 40'000; ++i) {
        const float radians = static_cast<float>(i) * 1e-4f;
        const Direction way = direction_of(radians);
        ASSERT_NEAR(way.x, std::cos(static_cast<double>(radians)), 5e-7) << radians;
        ASSERT_NEAR(way.y, std::sin(static_cast<double>(radians)), 5e-7) << radians;
    }
}

} // namespace
} // namespace evod::base
