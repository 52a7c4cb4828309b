#include "server/physics/motion_report.h"

#include "server/physics/shapes.h"
#include "tests/unit/physics/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace evod::physics {
namespace {

MotionReport report_of(const Scene& scene) {
    return report_motion(scene.circles, scene.boxes, scene.area, 1.0 / 60, scene.stepper.near());
}

TEST(MotionReport, OfNothingIsNothing) {
    const MotionReport report = report_of(Scene{});
    EXPECT_EQ(report.body_count, 0u);
    EXPECT_EQ(report.kinetic_energy, 0);
    EXPECT_EQ(report.deepest_overlap_px, 0);
    EXPECT_EQ(report.fastest_step, 0);
}

TEST(MotionReport, AddsEnergyAndMomentumOfWhatCanMove) {
    Scene scene;
    scene.add_circle(100, 100, 10, 2, 3, -4);       // 2 kg at 5 px/s
    scene.add_circle(200, 100, 4, 0.5, -60, 0);     // 0.5 kg at 60 px/s
    scene.add_box(300, 100, 20, 8, 0.25, 0, 12);    // 4 kg at 12 px/s
    scene.add_box(400, 100, 20, 20, 0, 1000, 1000); // immovable, whatever it says
    const MotionReport report = report_of(scene);
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

TEST(MotionReport, TellsTheDeepestOverlapOfEachKindOfPair) {
    {
        Scene scene; // 10 + 6 of radius, 13 apart; another pair that overlaps less
        scene.add_circle(100, 100, 10, 1);
        scene.add_circle(113, 100, 6, 1);
        scene.add_circle(500, 100, 10, 1);
        scene.add_circle(500, 119, 10, 1);
        const MotionReport report = report_of(scene);
        EXPECT_EQ(report.touching_count, 2u);
        EXPECT_FLOAT_EQ(static_cast<float>(report.deepest_overlap_px), 3);
        EXPECT_FLOAT_EQ(static_cast<float>(report.deepest_overlap_share), 0.5f);
    }
    {
        Scene scene; // a circle 2 px deep in an obstacle, a crate 1 px deep in it
        scene.add_box(100, 100, 20, 20, 0);
        scene.add_circle(126, 100, 8, 1);
        scene.add_box(100, 129, 5, 10, 0.5);
        const MotionReport report = report_of(scene);
        EXPECT_EQ(report.touching_count, 2u);
        EXPECT_FLOAT_EQ(static_cast<float>(report.deepest_overlap_px), 2);
        EXPECT_FLOAT_EQ(static_cast<float>(report.deepest_overlap_share), 0.25f);
    }
    {
        Scene scene; // 3 px beyond the wall at 0, of 12
        scene.add_circle(9, 100, 12, 1);
        scene.add_circle(500, 500, 12, 1);
        const MotionReport report = report_of(scene);
        EXPECT_EQ(report.touching_count, 0u);
        EXPECT_DOUBLE_EQ(report.deepest_overlap_px, 3);
        EXPECT_DOUBLE_EQ(report.deepest_overlap_share, 0.25);
    }
    {
        Scene scene; // a crate 4 px beyond the far wall, of 8
        scene.area = {to_units(400.0), to_units(300.0)};
        scene.add_box(200, 296, 30, 8, 1);
        const MotionReport report = report_of(scene);
        EXPECT_DOUBLE_EQ(report.deepest_overlap_px, 4);
        EXPECT_DOUBLE_EQ(report.deepest_overlap_share, 0.5);
    }
}

TEST(MotionReport, SpeedAndOverlapOfTwoThatMoveIntoEachOther) {
    // 30 px/s each in ticks of 1/60 s: half a pixel a tick each.
    Scene scene;
    scene.parameters.restitution = 1;
    scene.add_circle(100, 100, 5, 1, 30, 0);
    scene.add_circle(110.75, 100, 5, 1, -30, 0);
    scene.step(); // 0.75 px apart; then 0.25 px deep, which the next tick resolves
    EXPECT_NEAR(report_of(scene).deepest_overlap_px, 0.25, 1.0 / units_per_px);
    EXPECT_EQ(report_of(scene).touching_count, 1u);
    EXPECT_DOUBLE_EQ(report_of(scene).kinetic_energy, 900);
    scene.step();
    EXPECT_EQ(report_of(scene).deepest_overlap_px, 0);
    EXPECT_DOUBLE_EQ(report_of(scene).kinetic_energy, 900) << "an elastic collision";
}

/// Circles, crates and obstacles all over each other, some of them beyond the walls.
Scene dense(std::size_t circles, std::uint64_t seed) {
    constexpr double side = 700;
    Scene scene;
    scene.area = {to_units(side), to_units(side)};
    base::RandomStream random = scene_stream(seed);
    for (std::size_t i = 0; i < circles; ++i) {
        const double x = random.uniform(0, side), y = random.uniform(0, side);
        const float radius = uniform_float(random, 6, 12), vx = uniform_float(random, -30, 30);
        scene.add_circle(x, y, radius, radius / 10, vx, uniform_float(random, -30, 30));
    }
    for (int i = 0; i < 25; ++i) {
        const double x = random.uniform(0, side), y = random.uniform(0, side);
        scene.add_box(x, y, 20, 15, i < 15 ? 0.25f : 0.0f, i < 15 ? 40.0f : 0.0f);
    }
    return scene;
}

/// The same, from every pair there is.
MotionReport from_all_pairs(const Scene& scene) {
    const Circles& c = scene.circles;
    const Boxes& b = scene.boxes;
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

TEST(MotionReport, OfACrowdIsThatOfAllItsPairsWhetherNearOnesAreKnownOrNot) {
    Scene scene = dense(600, 7);
    bool was_worn = false, was_known = false;
    for (int tick = 0; tick < 100; ++tick) {
        if (tick == 50) {
            for (std::size_t i = 0; i < 200; ++i) { // a third of them die
                scene.stepper.near().remove(i);
                scene.circles.remove(i);
            }
        }
        const MotionReport report = report_of(scene), reference = from_all_pairs(scene);
        EXPECT_EQ(report.body_count, tick < 50 ? 615u : 415u);
        EXPECT_EQ(report.touching_count, reference.touching_count) << "tick " << tick;
        if (tick > 0) { // nobody is beyond a wall any more
            EXPECT_DOUBLE_EQ(report.deepest_overlap_px, reference.deepest_overlap_px) << "tick " << tick;
            EXPECT_DOUBLE_EQ(report.deepest_overlap_share, reference.deepest_overlap_share) << "tick " << tick;
        }
        (scene.stepper.near().worn(scene.circles, scene.boxes) ? was_worn : was_known) = true;
        scene.step();
    }
    EXPECT_TRUE(was_worn && was_known);
}

TEST(MotionReport, DoesNotDependOnTheOrderInMemory) {
    Scene scene = dense(500, 8);
    const MotionReport before = report_of(scene);
    std::vector<std::uint32_t> order(scene.circles.size());
    std::iota(order.begin(), order.end(), 0u);
    base::RandomStream random = scene_stream(9);
    random.shuffle(std::span{order});
    base::Column<std::uint32_t> spare;
    base::InlineExecutor executor;
    scene.circles.reorder(Reordering{order, spare, executor});
    const MotionReport after = report_of(scene);
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
