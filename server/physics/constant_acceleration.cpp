#include "server/physics/constant_acceleration.h"

#include "server/base/inline_executor.h"
#include "server/physics/step.h"

#include <vector>

namespace evod::physics {
namespace {

constexpr double px_per_metre = 1024; // a power of two: the conversion is exact
constexpr double start_px = 120'000;

} // namespace

StraightMotion accelerate_from_rest(Integrator integrator, double acceleration_m_s2, double tick_s, int tick_count) {
    const Area area{to_units(2 * start_px), to_units(2 * start_px)};
    const StepParameters parameters{
        .integration = integration(integrator, tick_s, 0), .restitution = 1, .max_speed_px_s = 1e6f};
    Circles circles;
    Boxes boxes;
    circles.add({.id = 0, .x = to_units(start_px), .y = to_units(start_px), .radius = 5, .mass = 1});
    std::vector<float> force_x(circles.x.size()), force_y(circles.x.size());
    force_x[0] = static_cast<float>(acceleration_m_s2 * px_per_metre);

    Stepper stepper;
    base::InlineExecutor executor;
    for (int tick = 0; tick < tick_count; ++tick) {
        stepper.step(circles, boxes, area, parameters, {force_x.data(), force_y.data()}, executor);
    }
    return {(to_px(circles.x[0]) - start_px) / px_per_metre, static_cast<double>(circles.velocity_x[0]) / px_per_metre};
}

} // namespace evod::physics
