#include "server/physics/step.h"

#include <algorithm>
#include <cmath>

namespace evod::physics {
namespace {

void accelerate_all(Bodies& bodies, const Integration& integration) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        bodies.velocity_x[i] =
            accelerate(integration, bodies.velocity_x[i], bodies.force_x[i] * bodies.inverse_mass[i]);
        bodies.velocity_y[i] =
            accelerate(integration, bodies.velocity_y[i], bodies.force_y[i] * bodies.inverse_mass[i]);
    }
}

/// Cuts a velocity to `limit`, px/s; whether it had to.
bool limit_speed(float& vx, float& vy, float limit) {
    const float square = vx * vx + vy * vy;
    if (square <= limit * limit)
        return false;
    const float share = limit / std::sqrt(square);
    vx *= share;
    vy *= share;
    return true;
}

/// extent(i)  the radius, or least half side, px.
/// drift      what explicit Euler adds to the velocity that moves a body, or nullptr. The limit acts on both
/// velocities.
template <class Extent>
void move_all(Bodies& bodies, const StepParameters& parameters, const float* drift_x, const float* drift_y,
              Extent&& extent, StepCounts& counts) {
    const float limit = parameters.max_speed_px_s;
    const float tick_s = parameters.integration.tick_s;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        float &vx = bodies.velocity_x[i], &vy = bodies.velocity_y[i];
        float moving_x = drift_x == nullptr ? vx : vx + drift_x[i];
        float moving_y = drift_y == nullptr ? vy : vy + drift_y[i];
        counts.speed_limited += limit_speed(vx, vy, limit);
        limit_speed(moving_x, moving_y, limit);
        const float way_x = moving_x * tick_s, way_y = moving_y * tick_s;
        bodies.x[i] += to_units(way_x);
        bodies.y[i] += to_units(way_y);
        counts.too_fast += way_x * way_x + way_y * way_y > extent(i) * extent(i);
        bodies.force_x[i] = 0;
        bodies.force_y[i] = 0;
    }
}

} // namespace

StepCounts Stepper::step(Circles& circles, Boxes& boxes, const Area& area, const StepParameters& parameters,
                         base::Executor& executor) {
    const bool is_explicit = parameters.integration.integrator == Integrator::ExplicitEuler;
    if (is_explicit) {
        drift_x_ = circles.velocity_x;
        drift_y_ = circles.velocity_y;
        drift_x_.insert(drift_x_.end(), boxes.velocity_x.begin(), boxes.velocity_x.end());
        drift_y_.insert(drift_y_.end(), boxes.velocity_y.begin(), boxes.velocity_y.end());
    }
    accelerate_all(circles, parameters.integration);
    accelerate_all(boxes, parameters.integration);
    if (is_explicit) {
        for (std::size_t i = 0; i < circles.size(); ++i) {
            drift_x_[i] -= circles.velocity_x[i];
            drift_y_[i] -= circles.velocity_y[i];
        }
        for (std::size_t i = 0, j = circles.size(); i < boxes.size(); ++i, ++j) {
            drift_x_[j] -= boxes.velocity_x[i];
            drift_y_[j] -= boxes.velocity_y[i];
        }
    }

    bounce_off_walls(circles, boxes, area, parameters.restitution);
    contacts_.find(circles, boxes, area, executor);
    contacts_.resolve(circles, boxes, parameters.restitution);

    StepCounts counts;
    const float* drift_x = is_explicit ? drift_x_.data() : nullptr;
    const float* drift_y = is_explicit ? drift_y_.data() : nullptr;
    move_all(
        circles, parameters, drift_x, drift_y, [&](std::size_t i) { return circles.radius[i]; }, counts);
    move_all(
        boxes, parameters, is_explicit ? drift_x + circles.size() : nullptr,
        is_explicit ? drift_y + circles.size() : nullptr,
        [&](std::size_t i) { return std::min(boxes.half_width[i], boxes.half_height[i]); }, counts);
    keep_inside(circles, boxes, area, parameters.restitution);
    return counts;
}

} // namespace evod::physics
