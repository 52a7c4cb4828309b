#include "proto/codec/steps.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

namespace evod::codec {
namespace {

constexpr std::int32_t px = 4096; // fixed-point units
constexpr std::int32_t least = std::numeric_limits<std::int32_t>::min(),
                       most = std::numeric_limits<std::int32_t>::max();

TEST(Steps, WideIslandsNeedFourBytePositions) {
    EXPECT_EQ(position_bytes_of(4095.9375, 720), 2U);
    EXPECT_EQ(position_bytes_of(4096, 720), 4U);
    EXPECT_EQ(position_bytes_of(720, 4096), 4U);
}

TEST(Steps, PositionsAreRoundedToTheNearestStep) {
    const PositionInSteps in_steps{12, 2};
    EXPECT_EQ(in_steps(0), 0U);
    EXPECT_EQ(in_steps(px), 16U);
    EXPECT_EQ(in_steps(px / 32 - 1), 0U);
    EXPECT_EQ(in_steps(px / 32), 1U);
    EXPECT_EQ(in_steps(3 * px / 32 - 1), 1U);
}

TEST(Steps, NumbersOutOfRangeAreClamped) {
    for (const unsigned bits : {4U, 12U, 30U}) {
        EXPECT_EQ((PositionInSteps{bits, 2}(least)), 0U);
        EXPECT_EQ((PositionInSteps{bits, 4}(least)), 0U);
    }
    EXPECT_EQ((PositionInSteps{12, 2}(most)), 0xffffU);
    EXPECT_EQ((PositionInSteps{12, 4}(most)), (1U << 23) - 1);
    EXPECT_EQ((PositionInSteps{4, 4}(most)), static_cast<std::uint32_t>(most));
    const float infinity = std::numeric_limits<float>::infinity();
    EXPECT_EQ(size_in_steps(-1.F), 0U);
    EXPECT_EQ(size_in_steps(-infinity), 0U);
    EXPECT_EQ(size_in_steps(5000.F), 0xffffU);
    EXPECT_EQ(size_in_steps(infinity), 0xffffU);
    EXPECT_EQ(size_in_steps(std::nanf("")), 0U);
    EXPECT_EQ(size_in_steps(-0.F), 0U);
    EXPECT_EQ(size_in_steps(8.0625F), 129U);
}

RC_GTEST_PROP(Steps, RoundingMovesAPositionByHalfAStepAtMost, (bool wide)) {
    const std::int32_t width_px = wide ? 100'000 : 4000;
    const PositionInSteps in_steps{12, position_bytes_of(width_px, 1)};
    const auto position = *rc::gen::inRange<std::int32_t>(0, width_px * px);
    RC_ASSERT(std::abs(in_steps(position) / 16.0 - position / double{px}) <= 1.0 / 32);
}

TEST(Steps, HeadingsAreRoundedToTheNearestStep) {
    for (std::uint32_t steps = 0; steps < heading_steps; ++steps) {
        EXPECT_EQ(heading_in_steps(radians_of(steps)), steps);
        EXPECT_LE(std::abs(radians_of(steps)), 3.1415928F);
    }
    EXPECT_EQ(heading_in_steps(0.0122F), 0U);
    EXPECT_EQ(heading_in_steps(0.0124F), 1U);
    EXPECT_EQ(heading_in_steps(-0.0124F), 255U);
    EXPECT_EQ(heading_in_steps(3.1416F), 128U);
    EXPECT_EQ(heading_in_steps(-3.1416F), 128U);
}

TEST(Steps, PxAndStepsConvertBothWays) {
    for (const std::uint32_t steps : {0U, 1U, 17U, 0xffffU, (1U << 24) - 1, 1U << 30}) {
        EXPECT_EQ(steps_of(px_of(steps)), steps);
    }
    EXPECT_EQ(px_of(129), 8.0625F);
    EXPECT_EQ(steps_of(1.03125F), 17U) << "half a step is rounded up";
    EXPECT_EQ(steps_of(-1.F), 0U);
    EXPECT_EQ(steps_of(std::numeric_limits<float>::max()), 0x7fff'ffffU);
}

} // namespace
} // namespace evod::codec
