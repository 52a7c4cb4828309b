// Scene: circles and boxes in an area, and the steps of them, for tests of physics.
#pragma once

#include "server/base/inline_executor.h"
#include "server/base/random.h"
#include "server/physics/step.h"

#include <cstdint>
#include <ostream>

namespace evod::physics {

struct Scene {
    Area area{to_units(300'000.0), to_units(300'000.0)};
    Circles circles;
    Boxes boxes;
    StepParameters parameters{
        .integration = {Integrator::SymplecticEuler, 1.0f / 60, 1}, .restitution = 0.8f, .max_speed_px_s = 100'000};
    Stepper stepper;
    StepCounts counts; // of all steps so far

    void add_circle(double x, double y, float radius, float mass, float velocity_x = 0, float velocity_y = 0) {
        circles.add(static_cast<std::uint32_t>(circles.size()), to_units(x), to_units(y), radius, mass);
        circles.velocity_x.back() = velocity_x;
        circles.velocity_y.back() = velocity_y;
    }
    void add_box(double x, double y, float half_width, float half_height, float inverse_mass, float velocity_x = 0,
                 float velocity_y = 0) {
        boxes.add(to_units(x), to_units(y), half_width, half_height, inverse_mass);
        boxes.velocity_x.back() = velocity_x;
        boxes.velocity_y.back() = velocity_y;
    }
    void step() {
        base::InlineExecutor executor;
        step(executor);
    }
    void step(base::Executor& executor) {
        const StepCounts now = stepper.step(circles, boxes, area, parameters, executor);
        counts.too_fast += now.too_fast;
        counts.speed_limited += now.speed_limited;
    }
};

/// For the names of tests.
inline void PrintTo(Integrator integrator, std::ostream* out) {
    constexpr const char* names[] = {"SymplecticEuler", "ExplicitEuler", "BackwardEuler"};
    *out << names[static_cast<std::size_t>(integrator)];
}

inline base::RandomStream scene_stream(std::uint64_t seed) {
    return {base::RandomKey{base::Seed{seed}, base::Purpose::ScenarioTest, 0, 0}, 0};
}

inline float uniform_float(base::RandomStream& random, double low, double high) {
    return static_cast<float>(random.uniform(low, high));
}

} // namespace evod::physics
