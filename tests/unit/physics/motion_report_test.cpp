#include "server/physics/motion_report.h"

#include "server/physics/shapes.h"
#include "tests/unit/physics/test_bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace evod::physics {
namespace {

MotionReport report_of(const TestBodies& setup) {
    return report_motion(setup.circles, setup.boxes, setup.area, 1.0 / 60, setup.stepper.near());
}

TEST(MotionReport, OfNoBodiesIsAllZero) {
    const MotionReport report = report_of(TestBodies{});
    EXPECT_EQ(report.body_count, 0u);
    EXPECT_EQ(report.kinetic_energy, 0);
    EXPECT_EQ(report.deepest_overlap_px, 0);
    EXPECT_EQ(report.fastest_step, 0);
}

TEST(MotionReport, AddsEnergyAndMomentumOfMovableBodies) {
    TestBodies setup;
    setup.add_circle(100, 100, 10, 2, 3, -4);       // 2 kg at 5 px/s
    setup.add_circle(200, 100, 4, 0.5, -60, 0);     // 0.5 kg at 60 px/s
    setup.add_box(300, 100, 20, 8, 0.25, 0, 12);    // 4 kg at 12 px/s
    setup.add_box(400, 100, 20, 20, 0, 1000, 1000); // immovable, despite its velocity
    const MotionReport report = report_of(setup);
    EXPECT_EQ(report.body_count, 3u);
    EXPECT_DOUBLE_EQ(report.kinetic_energy, 25 + 900 + 288);
    EXPECT_DOUBLE_EQ(report.momentum_x, 6 - 30);
    EXPECT_DOUBLE_EQ(report.momentum_y, -8 + 48);
    EXPECT_DOUBLE_EQ(report.fastest_px_s, 60);
    EXPECT_DOUBLE_EQ(report.fastest_step, 60.0 / 60 / 4);
    EXPECT_EQ(report.touching_count, 0u);
    EXPECT_EQ(report.deepest_overlap_px, 0);
    EXPECT_GE(report.strip_px, 20) << "as high as the largest circle, at least";
}

TEST(MotionReport, HasTheDeepestOverlapOfEachKindOfPair) {
    {
        TestBodies setup; // radii 10 + 6, 13 px apart; another pair overlaps less
        setup.add_circle(100, 100, 10, 1);
        setup.add_circle(113, 100, 6, 1);
        setup.add_circle(500, 100, 10, 1);
        setup.add_circle(500, 119, 10, 1);
        const MotionReport report = report_of(setup);
        EXPECT_EQ(report.touching_count, 2u);
        EXPECT_FLOAT_EQ(static_cast<float>(report.deepest_overlap_px), 3);
        EXPECT_FLOAT_EQ(static_cast<float>(report.deepest_overlap_share), 0.5f);
    }
    {
        TestBodies setup; // a circle 2 px inside an obstacle, a crate 1 px inside it
        setup.add_box(100, 100, 20, 20, 0);
        setup.add_circle(126, 100, 8, 1);
        setup.add_box(100, 129, 5, 10, 0.5);
        const MotionReport report = report_of(setup);
        EXPECT_EQ(report.touching_count, 2u);
        EXPECT_FLOAT_EQ(static_cast<float>(report.deepest_overlap_px), 2);
        EXPECT_FLOAT_EQ(static_cast<float>(report.deepest_overlap_share), 0.25f);
    }
    {
        TestBodies setup; // 3 px beyond the wall at 0, radius 12
        setup.add_circle(9, 100, 12, 1);
        setup.add_circle(500, 500, 12, 1);
        const MotionReport report = report_of(setup);
        EXPECT_EQ(report.touching_count, 0u);
        EXPECT_DOUBLE_EQ(report.deepest_overlap_px, 3);
        EXPECT_DOUBLE_EQ(report.deepest_overlap_share, 0.25);
    }
    {
        TestBodies setup; // a crate 4 px beyond the far wall, half side 8
        setup.area = {to_units(400.0), to_units(300.0)};
        setup.add_box(200, 296, 30, 8, 1);
        const MotionReport report = report_of(setup);
        EXPECT_DOUBLE_EQ(report.deepest_overlap_px, 4);
        EXPECT_DOUBLE_EQ(report.deepest_overlap_share, 0.5);
    }
}

TEST(MotionReport, HasSpeedAndOverlapOfCollidingBodies) {
    // 30 px/s each, in ticks of 1/60 s: half a pixel per tick each.
    TestBodies setup;
    setup.parameters.restitution = 1;
    setup.add_circle(100, 100, 5, 1, 30, 0);
    setup.add_circle(110.75, 100, 5, 1, -30, 0);
    setup.step(); // 0.75 px apart; then 0.25 px of overlap, which the next tick resolves
    EXPECT_NEAR(report_of(setup).deepest_overlap_px, 0.25, 1.0 / units_per_px);
    EXPECT_EQ(report_of(setup).touching_count, 1u);
    EXPECT_DOUBLE_EQ(report_of(setup).kinetic_energy, 900);
    setup.step();
    EXPECT_EQ(report_of(setup).deepest_overlap_px, 0);
    EXPECT_DOUBLE_EQ(report_of(setup).kinetic_energy, 900) << "an elastic collision";
}

/// Circles, crates and obstacles that overlap, some of them beyond the walls.
TestBodies dense(std::size_t circles, std::uint64_t seed) {
    constexpr double side = 700;
    TestBodies setup;
    setup.area = {to_units(side), to_units(side)};
    base::RandomStream random = test_stream(seed);
    for (std::size_t i = 0; i < circles; ++i) {
        const double x = random.uniform(0, side), y = random.uniform(0, side);
        const float radius = uniform_float(random, 6, 12), vx = uniform_float(random, -30, 30);
        setup.add_circle(x, y, radius, radius / 10, vx, uniform_float(random, -30, 30));
    }
    for (int i = 0; i < 25; ++i) {
        const double x = random.uniform(0, side), y = random.uniform(0, side);
        setup.add_box(x, y, 20, 15, i < 15 ? 0.25f : 0.0f, i < 15 ? 40.0f : 0.0f);
    }
    return setup;
}

/// The same report, from all possible pairs.
MotionReport from_all_pairs(const TestBodies& setup) {
    const Circles& c = setup.circles;
    const Boxes& b = setup.boxes;
    MotionReport report;
    const auto touch = [&](const Overlap& overlap, float extent) {
        report.touching_count += overlap.touching;
        const auto depth = static_cast<double>(overlap.depth);
        report.deepest_overlap_px = std::max(report.deepest_overlap_px, depth);
        report.deepest_overlap_share = std::max(report.deepest_overlap_share, depth / static_cast<double>(extent));
    };
    const auto apart = [](const Bodies& a, std::size_t i, const Bodies& other, std::size_t j) {
        return std::pair{distance_px(a.x[i], other.x[j]), distance_px(a.y[i], other.y[j])};
    };
    const auto shape = [&](std::size_t i) { return BoxShape{b.half_width[i], b.half_height[i]}; };
    const auto half_side = [&](std::size_t i) { return std::min(b.half_width[i], b.half_height[i]); };
    for (std::size_t i = 0; i < c.size(); ++i) {
        if (c.is_void(i)) {
            continue;
        }
        for (std::size_t j = i + 1; j < c.size(); ++j) {
            if (!c.is_void(j)) {
                const auto [dx, dy] = apart(c, i, c, j);
                touch(circle_circle(dx, dy, c.radius[i], c.radius[j]), std::min(c.radius[i], c.radius[j]));
            }
        }
        for (std::size_t j = 0; j < b.size(); ++j) {
            const auto [dx, dy] = apart(b, j, c, i);
            touch(box_circle(dx, dy, shape(j), c.radius[i]), std::min(c.radius[i], half_side(j)));
        }
    }
    for (std::size_t i = 0; i < b.size(); ++i) {
        for (std::size_t j = i + 1; j < b.size(); ++j) {
            if (b.inverse_mass[i] + b.inverse_mass[j] > 0) {
                const auto [dx, dy] = apart(b, i, b, j);
                touch(box_box(dx, dy, shape(i), shape(j)), std::min(half_side(i), half_side(j)));
            }
        }
    }
    return report;
}

TEST(MotionReport, EqualsThatOfAllPairsWithFreshAndStaleLists) {
    TestBodies setup = dense(600, 7);
    bool was_stale = false, was_known = false;
    for (int tick = 0; tick < 100; ++tick) {
        if (tick == 50) {
            for (std::size_t i = 0; i < 200; ++i) { // a third of them die
                setup.stepper.near().remove(i);
                setup.circles.remove(i);
            }
        }
        const MotionReport report = report_of(setup), reference = from_all_pairs(setup);
        EXPECT_EQ(report.body_count, tick < 50 ? 615u : 415u);
        EXPECT_EQ(report.touching_count, reference.touching_count) << "tick " << tick;
        if (tick > 0) { // all bodies are inside the walls again
            EXPECT_DOUBLE_EQ(report.deepest_overlap_px, reference.deepest_overlap_px) << "tick " << tick;
            EXPECT_DOUBLE_EQ(report.deepest_overlap_share, reference.deepest_overlap_share) << "tick " << tick;
        }
        (setup.stepper.near().stale(setup.circles, setup.boxes) ? was_stale : was_known) = true;
        setup.step();
    }
    EXPECT_TRUE(was_stale && was_known);
}

TEST(MotionReport, DoesNotDependOnTheOrderInMemory) {
    TestBodies setup = dense(500, 8);
    const MotionReport before = report_of(setup);
    std::vector<std::uint32_t> order(setup.circles.size());
    std::iota(order.begin(), order.end(), 0u);
    base::RandomStream random = test_stream(9);
    random.shuffle(std::span{order});
    base::Column<std::uint32_t> spare;
    base::InlineExecutor executor;
    setup.circles.reorder(Reordering{order, spare, executor});
    const MotionReport after = report_of(setup);
    EXPECT_EQ(after.kinetic_energy, before.kinetic_energy);
    EXPECT_EQ(after.momentum_x, before.momentum_x);
    EXPECT_EQ(after.momentum_y, before.momentum_y);
    EXPECT_EQ(after.touching_count, before.touching_count);
    EXPECT_EQ(after.deepest_overlap_px, before.deepest_overlap_px);
    EXPECT_EQ(after.deepest_overlap_share, before.deepest_overlap_share);
    EXPECT_GT(before.kinetic_energy, 0);
}

} // namespace
} // namespace evod::physics
