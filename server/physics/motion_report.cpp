#include "server/physics/motion_report.h"

#include "server/base/assert.h"
#include "server/base/inline_executor.h"
#include "server/physics/shapes.h"

#include <algorithm>
#include <cmath>

namespace evod::physics {
namespace {

double rounded_for_sums(double x) {
    constexpr double parts = 1 << 16;
    return std::rint(x * parts) / parts;
}

/// Adds the motion of `count` bodies to `report`. extent_of(i) must return the radius or least half side of body i, px.
template <class ExtentOf>
void add_motion(MotionReport& report, const Bodies& bodies, std::size_t count, double tick_s, ExtentOf&& extent_of) {
    for (std::size_t i = 0; i < count; ++i) {
        if (bodies.inverse_mass[i] == 0) {
            continue; // also skips void bodies
        }
        const double mass = 1 / static_cast<double>(bodies.inverse_mass[i]);
        const auto vx = static_cast<double>(bodies.velocity_x[i]), vy = static_cast<double>(bodies.velocity_y[i]);
        const double square = vx * vx + vy * vy, speed = std::sqrt(square);
        ++report.body_count;
        report.kinetic_energy += rounded_for_sums(mass * square / 2);
        report.momentum_x += rounded_for_sums(mass * vx);
        report.momentum_y += rounded_for_sums(mass * vy);
        report.fastest_px_s = std::max(report.fastest_px_s, speed);
        report.fastest_step = std::max(report.fastest_step, speed * tick_s / extent_of(i));
    }
}

void add_overlap(MotionReport& report, double depth, double extent) {
    report.deepest_overlap_px = std::max(report.deepest_overlap_px, depth);
    report.deepest_overlap_share = std::max(report.deepest_overlap_share, depth / extent);
}

/// Returns how far a body extends beyond the walls along one axis, px.
double beyond(Coordinate position, float extent_px, Coordinate size) {
    const Coordinate extent = to_units(extent_px); // rounded as in the test against walls
    return to_px(std::max({extent - position, position + extent - size, 0}));
}

MotionReport report(const Circles& circles, const Boxes& boxes, const Area& area, double tick_s,
                    const NearPairs& near) {
    MotionReport report;
    report.strip_px = near.strips().strip_height_px();
    const auto radius = [&](std::size_t i) { return static_cast<double>(circles.radius[i]); };
    const auto half_side = [&](std::size_t i) {
        return static_cast<double>(std::min(boxes.half_width[i], boxes.half_height[i]));
    };
    add_motion(report, circles, circles.size(), tick_s, radius);
    add_motion(report, boxes, boxes.size(), tick_s, half_side);

    for (std::size_t i = 0; i < circles.size(); ++i) {
        if (circles.inverse_mass[i] > 0) {
            add_overlap(report,
                        std::max(beyond(circles.x[i], circles.radius[i], area.width),
                                 beyond(circles.y[i], circles.radius[i], area.height)),
                        radius(i));
        }
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (boxes.inverse_mass[i] > 0) {
            add_overlap(report,
                        std::max(beyond(boxes.x[i], boxes.half_width[i], area.width),
                                 beyond(boxes.y[i], boxes.half_height[i], area.height)),
                        half_side(i));
        }
    }

    const auto add_pair = [&](const Overlap& overlap, double smaller_extent) {
        if (!overlap.touching) {
            return;
        }
        ++report.touching_count;
        add_overlap(report, static_cast<double>(overlap.depth), smaller_extent);
    };
    const auto shape = [&](std::size_t box) { return BoxShape{boxes.half_width[box], boxes.half_height[box]}; };
    for (std::size_t block = 0; block < block_count(circles.size()); ++block) {
        for (const auto [a, b] : near.circle_pairs(block)) {
            if (!circles.is_void(a) && !circles.is_void(b)) {
                add_pair(circle_circle(distance_px(circles.x[a], circles.x[b]), distance_px(circles.y[a], circles.y[b]),
                                       circles.radius[a], circles.radius[b]),
                         std::min(radius(a), radius(b)));
            }
        }
    }
    for (const auto [circle, box] : near.circle_box_pairs()) {
        if (!circles.is_void(circle)) {
            add_pair(box_circle(distance_px(boxes.x[box], circles.x[circle]),
                                distance_px(boxes.y[box], circles.y[circle]), shape(box), circles.radius[circle]),
                     std::min(radius(circle), half_side(box)));
        }
    }
    for (const auto [a, b] : near.box_pairs()) {
        add_pair(box_box(distance_px(boxes.x[a], boxes.x[b]), distance_px(boxes.y[a], boxes.y[b]), shape(a), shape(b)),
                 std::min(half_side(a), half_side(b)));
    }
    return report;
}

} // namespace

MotionReport report_motion(const Circles& circles, const Boxes& boxes, const Area& area, double tick_s,
                           const NearPairs& near) {
    EVOD_ASSERT(tick_s > 0);
    if (!near.stale(circles, boxes)) {
        return report(circles, boxes, area, tick_s, near);
    }
    NearPairs fresh;
    base::InlineExecutor executor;
    fresh.renew(circles, boxes, area, executor);
    return report(circles, boxes, area, tick_s, fresh);
}

} // namespace evod::physics
