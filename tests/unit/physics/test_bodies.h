// TestBodies: circles and boxes in an area, and their steps, for tests of physics.
#pragma once

#include "server/base/inline_executor.h"
#include "server/base/random.h"
#include "server/physics/step.h"

#include <algorithm>
#include <cstdint>
#include <ostream>
#include <vector>

namespace evod::physics {

struct TestBodies {
    Area area{to_units(300'000.0), to_units(300'000.0)};
    Circles circles;
    Boxes boxes;
    StepParameters parameters{
        .integration = {Integrator::SymplecticEuler, 1.0f / 60, 1}, .restitution = 0.8f, .max_speed_px_s = 100'000};
    Stepper stepper;
    StepCounts counts;                   // of all steps so far
    std::vector<float> force_x, force_y; // on each circle in the next step

    void push(std::size_t circle, float x, float y) {
        force_x.resize(circles.x.size(), 0);
        force_y.resize(circles.x.size(), 0);
        force_x[circle] += x;
        force_y[circle] += y;
    }

    void add_circle(double x, double y, float radius, float mass, float velocity_x = 0, float velocity_y = 0) {
        circles.add({.id = static_cast<std::uint32_t>(circles.size()),
                     .x = to_units(x),
                     .y = to_units(y),
                     .radius = radius,
                     .mass = mass});
        circles.velocity_x[circles.size() - 1] = velocity_x;
        circles.velocity_y[circles.size() - 1] = velocity_y;
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
        force_x.resize(circles.x.size(), 0);
        force_y.resize(circles.x.size(), 0);
        const StepCounts now =
            stepper.step(circles, boxes, area, parameters, {force_x.data(), force_y.data()}, executor);
        std::fill(force_x.begin(), force_x.end(), 0.0f);
        std::fill(force_y.begin(), force_y.end(), 0.0f);
        counts.too_fast += now.too_fast;
        counts.speed_limited += now.speed_limited;
    }
};

/// For the names of tests.
inline void PrintTo(Integrator integrator, std::ostream* out) {
    constexpr const char* names[] = {"SymplecticEuler", "ExplicitEuler", "BackwardEuler"};
    *out << names[static_cast<std::size_t>(integrator)];
}

inline base::RandomStream test_stream(std::uint64_t seed) {
    return {base::RandomKey{base::Seed{seed}, base::Purpose::ScenarioTest, 0, 0}, 0};
}

inline float uniform_float(base::RandomStream& random, double low, double high) {
    return static_cast<float>(random.uniform(low, high));
}

} // namespace evod::physics
