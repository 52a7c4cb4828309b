#include "server/physics/shapes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

namespace evod::physics {
namespace {

void expect_overlap(const Overlap& overlap, float depth, float normal_x, float normal_y) {
    EXPECT_TRUE(overlap.touching);
    EXPECT_FLOAT_EQ(overlap.depth, depth);
    EXPECT_FLOAT_EQ(overlap.normal_x, normal_x);
    EXPECT_FLOAT_EQ(overlap.normal_y, normal_y);
}

TEST(CircleCircle, OverlapIsTheSumOfRadiiMinusTheDistance) {
    expect_overlap(circle_circle(3, 4, 4, 3), 2, 0.6f, 0.8f);
    expect_overlap(circle_circle(-3, 0, 2, 2), 1, -1, 0);
    EXPECT_FALSE(circle_circle(3, 4, 2, 2.99f).touching);
}

TEST(CircleCircle, ThatShareOnePointTouchWithDepthZero) {
    expect_overlap(circle_circle(3, 4, 2, 3), 0, 0.6f, 0.8f);
    expect_overlap(circle_circle(0, -7, 5, 2), 0, 0, -1);
}

TEST(CircleCircle, AtEqualCentresSeparateAlongXByTheSumOfRadii) {
    expect_overlap(circle_circle(0, 0, 2, 3), 5, 1, 0);
}

TEST(CircleCircle, OneInsideTheOtherLeavesTheShortestWay) {
    expect_overlap(circle_circle(0, 1, 10, 2), 11, 0, 1);
}

TEST(BoxBox, OverlapAlongTheAxisOfLeastPenetration) {
    expect_overlap(box_box(3, 1, {2, 2}, {2, 2}), 1, 1, 0);
    expect_overlap(box_box(-1, -3, {2, 2}, {2, 2}), 1, 0, -1);
    EXPECT_FALSE(box_box(4.01f, 0, {2, 2}, {2, 2}).touching);
    EXPECT_FALSE(box_box(0, 4.01f, {2, 2}, {2, 2}).touching);
}

TEST(BoxBox, ThatShareAnEdgeOrACornerTouchWithDepthZero) {
    expect_overlap(box_box(4, 1, {2, 2}, {2, 2}), 0, 1, 0);
    expect_overlap(box_box(1, -4, {2, 2}, {2, 2}), 0, 0, -1);
    expect_overlap(box_box(-4, 4, {2, 2}, {2, 2}), 0, -1, 0);
}

TEST(BoxBox, OfEqualOverlapsSeparateAlongX) {
    expect_overlap(box_box(-3, 3, {2, 2}, {2, 2}), 1, -1, 0);
}

TEST(BoxBox, AtEqualCentresSeparateAlongTheNarrowerAxis) {
    expect_overlap(box_box(0, 0, {2, 3}, {1, 3}), 3, 1, 0);
    expect_overlap(box_box(0, 0, {3, 2}, {3, 1}), 3, 0, 1);
    expect_overlap(box_box(0, 0, {2, 2}, {2, 2}), 4, 1, 0);
}

TEST(BoxCircle, OverlapAtASideIsMeasuredToTheSide) {
    expect_overlap(box_circle(4, 0.5f, {2, 3}, 2.5f), 0.5f, 1, 0);
    expect_overlap(box_circle(-1, -4, {2, 3}, 1.5f), 0.5f, 0, -1);
    EXPECT_FALSE(box_circle(4, 0, {2, 3}, 1.99f).touching);
}

TEST(BoxCircle, OverlapAtACornerIsMeasuredToTheCorner) {
    expect_overlap(box_circle(5, 7, {2, 3}, 6), 1, 0.6f, 0.8f);
    EXPECT_FALSE(box_circle(5, 7, {2, 3}, 4.99f).touching) << "the box around the circle overlaps, the circle does not";
}

TEST(BoxCircle, ThatShareOnePointTouchWithDepthZero) {
    expect_overlap(box_circle(4, 0, {2, 3}, 2), 0, 1, 0);
    expect_overlap(box_circle(5, 7, {2, 3}, 5), 0, 0.6f, 0.8f);
}

TEST(BoxCircle, WithTheCentreInsideLeavesByTheNearestSide) {
    expect_overlap(box_circle(1.5f, 0, {2, 3}, 1), 1.5f, 1, 0);
    expect_overlap(box_circle(-0.5f, 2.75f, {2, 3}, 1), 1.25f, 0, 1);
    expect_overlap(box_circle(0.5f, -2.75f, {2, 3}, 1), 1.25f, 0, -1);
}

TEST(BoxCircle, WithTheCentreOnTheEdgeLeavesByThatSide) {
    expect_overlap(box_circle(2, 1, {2, 3}, 1), 1, 1, 0);
    expect_overlap(box_circle(-2, 1, {2, 3}, 1), 1, -1, 0);
    expect_overlap(box_circle(1, -3, {2, 3}, 1), 1, 0, -1);
    expect_overlap(box_circle(-2, 3, {2, 3}, 1), 1, -1, 0); // a corner: the x axis wins
}

TEST(BoxCircle, OfEquallyNearSidesLeavesAlongXThenTowardPlus) {
    expect_overlap(box_circle(1, -1, {2, 2}, 1), 2, 1, 0);
    expect_overlap(box_circle(0, 0, {2, 2}, 1), 3, 1, 0);
    expect_overlap(box_circle(0, 0, {3, 2}, 1), 3, 0, 1);
    expect_overlap(box_circle(0, 0, {2, 3}, 1), 3, 1, 0);
}

// Distances and sizes up to 100 px; tolerances are some rounding errors of such numbers.
float some(int low, int high) {
    return static_cast<float>(*rc::gen::resize(rc::kNominalSize, rc::gen::inRange(low * 4096, high * 4096))) / 4096;
}
constexpr float rounding_px = 1e-4f;

void require_unit_normal(const Overlap& overlap) {
    RC_ASSERT(overlap.depth >= 0.0f);
    RC_ASSERT(std::abs(overlap.normal_x * overlap.normal_x + overlap.normal_y * overlap.normal_y - 1) < 1e-6f);
}

RC_GTEST_PROP(CircleCircle, ApartByTheDepthAlongTheNormalJustTouch, ()) {
    const float dx = some(-60, 60), dy = some(-60, 60), a = some(1, 50), b = some(1, 50);
    const Overlap overlap = circle_circle(dx, dy, a, b);
    if (!overlap.touching) {
        return;
    }
    require_unit_normal(overlap);
    const float apart_x = dx + overlap.normal_x * overlap.depth, apart_y = dy + overlap.normal_y * overlap.depth;
    RC_ASSERT(std::abs(std::sqrt(apart_x * apart_x + apart_y * apart_y) - (a + b)) < rounding_px);
}

RC_GTEST_PROP(BoxBox, ApartByTheDepthAlongTheNormalJustTouch, ()) {
    const float dx = some(-60, 60), dy = some(-60, 60);
    const BoxShape a{some(1, 50), some(1, 50)}, b{some(1, 50), some(1, 50)};
    const Overlap overlap = box_box(dx, dy, a, b);
    if (!overlap.touching) {
        return;
    }
    require_unit_normal(overlap);
    const float apart_x = std::abs(dx + overlap.normal_x * overlap.depth);
    const float apart_y = std::abs(dy + overlap.normal_y * overlap.depth);
    const float gap_x = apart_x - (a.half_width + b.half_width), gap_y = apart_y - (a.half_height + b.half_height);
    RC_ASSERT(std::abs(std::max(gap_x, gap_y)) < rounding_px);
}

RC_GTEST_PROP(BoxCircle, ApartByTheDepthAlongTheNormalJustTouch, ()) {
    const float dx = some(-60, 60), dy = some(-60, 60), radius = some(1, 50);
    const BoxShape box{some(1, 50), some(1, 50)};
    const Overlap overlap = box_circle(dx, dy, box, radius);
    if (!overlap.touching) {
        return;
    }
    require_unit_normal(overlap);
    const float apart_x = std::abs(dx + overlap.normal_x * overlap.depth);
    const float apart_y = std::abs(dy + overlap.normal_y * overlap.depth);
    const float out_x = std::max(apart_x - box.half_width, 0.0f), out_y = std::max(apart_y - box.half_height, 0.0f);
    RC_ASSERT(std::abs(std::sqrt(out_x * out_x + out_y * out_y) - radius) < rounding_px);
}

RC_GTEST_PROP(CircleCircle, ExchangedShapesReverseTheNormal, ()) {
    const float dx = some(-60, 60), dy = some(-60, 60), a = some(1, 50), b = some(1, 50);
    const Overlap there = circle_circle(dx, dy, a, b), back = circle_circle(-dx, -dy, b, a);
    RC_ASSERT(there.touching == back.touching);
    RC_ASSERT(there.depth == back.depth);
    if (dx != 0 || dy != 0) {
        RC_ASSERT(there.normal_x == -back.normal_x);
        RC_ASSERT(there.normal_y == -back.normal_y);
    }
}

RC_GTEST_PROP(BoxBox, ExchangedShapesReverseTheNormal, ()) {
    const float dx = some(-60, 60), dy = some(-60, 60);
    if (dx == 0 || dy == 0) {
        return;
    }
    const BoxShape a{some(1, 50), some(1, 50)}, b{some(1, 50), some(1, 50)};
    const Overlap there = box_box(dx, dy, a, b), back = box_box(-dx, -dy, b, a);
    RC_ASSERT(there.touching == back.touching);
    RC_ASSERT(there.depth == back.depth);
    RC_ASSERT(there.normal_x == -back.normal_x);
    RC_ASSERT(there.normal_y == -back.normal_y);
}

} // namespace
} // namespace evod::physics
