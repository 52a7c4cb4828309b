#include "client/viewer/panels/physics/time_step_demo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace evod::viewer {
namespace {

using System = TimeStepDemo::System;
using State = TimeStepDemo::State;

System spring(double omega) {
    return {.omega_per_s = omega, .damping_per_s = 0, .start = {100, 0}};
}
System slowing(double damping) {
    return {.omega_per_s = 0, .damping_per_s = damping, .start = {0, 100}};
}

TEST(TimeStepDemo, SolvesTheSpringAndDampedMotionExactly) {
    for (const double t : {0.0, 0.3, 1.0, 7.5}) {
        const State swung = TimeStepDemo{spring(3)}.exact(t);
        EXPECT_NEAR(swung.x, 100 * std::cos(3 * t), 1e-9);
        EXPECT_NEAR(swung.v, -300 * std::sin(3 * t), 1e-9);
        const State slowed = TimeStepDemo{slowing(2)}.exact(t);
        EXPECT_NEAR(slowed.x, 50 * (1 - std::exp(-2 * t)), 1e-9);
        EXPECT_NEAR(slowed.v, 100 * std::exp(-2 * t), 1e-9);
        const State free = TimeStepDemo{slowing(0)}.exact(t);
        EXPECT_NEAR(free.x, 100 * t, 1e-9);
        EXPECT_NEAR(free.v, 100, 1e-9);
    }
}

TEST(TimeStepDemo, TheDampedSpringSatisfiesItsEquation) {
    // x'' + c·x' + ω²x = 0 by central differences; below, at and above critical damping.
    for (const double c : {1.0, 6.0, 9.0}) {
        const TimeStepDemo demo{{.omega_per_s = 3, .damping_per_s = c, .start = {40, 70}}};
        EXPECT_NEAR(demo.exact(0).x, 40, 1e-12);
        EXPECT_NEAR(demo.exact(0).v, 70, 1e-12);
        for (const double t : {0.2, 0.9, 2.0}) {
            constexpr double h = 1e-4;
            const State before = demo.exact(t - h), now = demo.exact(t), after = demo.exact(t + h);
            EXPECT_NEAR((after.x - before.x) / (2 * h), now.v, 1e-4) << c;
            EXPECT_NEAR((after.v - before.v) / (2 * h) + c * now.v + 9 * now.x, 0, 1e-3) << c;
        }
    }
}

TEST(TimeStepDemo, ExplicitEulerMultipliesTheEnergyEachStep) {
    const TimeStepDemo demo{spring(2)};
    const double dt = 0.05, start = demo.energy({100, 0});
    EXPECT_EQ(start, 2 * 100 * 100);
    EXPECT_DOUBLE_EQ(demo.explicit_growth(dt), 1.01);
    const auto rows = demo.rows(dt, 400);
    ASSERT_EQ(rows.size(), 401u);
    for (std::size_t n = 0; n < rows.size(); ++n) {
        EXPECT_NEAR(demo.energy(rows[n].explicit_euler) / (start * std::pow(1.01, n)), 1, 1e-12) << n;
    }
}

TEST(TimeStepDemo, SymplecticEulerBoundsTheEnergy) {
    // v² + ω²x² − ω²·dt·x·v is invariant, so the energy stays within a factor of 1 ± ω·dt/2 of it.
    const TimeStepDemo demo{spring(2)};
    const double dt = 0.1, bound = 2 * dt / 2, start = demo.energy({100, 0});
    double least = start, most = start;
    for (const auto& row : demo.rows(dt, 20'000)) {
        const auto [x, v] = row.symplectic_euler;
        EXPECT_NEAR((v * v + 4 * x * x - 4 * dt * x * v) / (2 * start), 1, 1e-9);
        least = std::min(least, demo.energy(row.symplectic_euler));
        most = std::max(most, demo.energy(row.symplectic_euler));
    }
    EXPECT_GE(least, start / (1 + bound));
    EXPECT_LE(most, start / (1 - bound));
    EXPECT_GT(most - least, start * bound) << "the energy oscillates";
}

TEST(TimeStepDemo, SymplecticEulerIsStableUpToTwoOverOmega) {
    const TimeStepDemo demo{spring(2)};
    const auto furthest = [&](double dt) {
        double most = 0;
        for (const auto& row : demo.rows(dt, 2000)) {
            most = std::max(most, std::abs(row.symplectic_euler.x));
        }
        return most;
    };
    EXPECT_TRUE(demo.symplectic_is_stable(0.99));
    EXPECT_LT(furthest(0.99), 1000);
    EXPECT_FALSE(demo.symplectic_is_stable(1.01));
    EXPECT_GT(furthest(1.01), 1e6);
}

TEST(TimeStepDemo, BothScaleTheVelocityOfDampedMotion) {
    const double c = 2, dt = 0.1, kept = 1 - c * dt;
    const auto rows = TimeStepDemo{slowing(c)}.rows(dt, 50);
    for (std::size_t n = 0; n < rows.size(); ++n) {
        const double share = std::pow(kept, n);
        EXPECT_DOUBLE_EQ(rows[n].t_s, static_cast<double>(n) * dt);
        EXPECT_NEAR(rows[n].explicit_euler.v, 100 * share, 1e-9);
        EXPECT_NEAR(rows[n].symplectic_euler.v, 100 * share, 1e-9);
        EXPECT_NEAR(rows[n].explicit_euler.x, 50 * (1 - share), 1e-9);
        EXPECT_NEAR(rows[n].symplectic_euler.x, 50 * kept * (1 - share), 1e-9);
    }
}

TEST(TimeStepDemo, ConstantAccelerationHasTheKnownErrors) {
    constexpr double a = 2, t = 2.4;
    const TimeStepDemo demo{{.omega_per_s = 0, .start = {0, 0}, .acceleration = a}};
    EXPECT_DOUBLE_EQ(demo.exact(t).x, 5.76);
    EXPECT_DOUBLE_EQ(demo.exact(t).v, 4.8);
    for (const std::size_t ticks : {3u, 6u, 12u, 24u, 48u}) {
        const double dt = t / static_cast<double>(ticks);
        const auto end = demo.rows(dt, ticks).back();
        // Each of the n additions rounds a double of up to 8 by at most 2⁻⁵¹.
        EXPECT_NEAR(end.symplectic_euler.x, 5.76 + a * t * dt / 2, 1e-12) << ticks;
        EXPECT_NEAR(end.explicit_euler.x, 5.76 - a * t * dt / 2, 1e-12) << ticks;
        EXPECT_NEAR(end.symplectic_euler.v, 4.8, 1e-12) << ticks;
        EXPECT_NEAR(end.explicit_euler.v, 4.8, 1e-12) << ticks;
    }
}

TEST(TimeStepDemo, ErrorsAreOfFirstOrder) {
    const TimeStepDemo demo{spring(2)};
    const auto error = [&](std::size_t steps, State TimeStepDemo::Row::*way) {
        const auto last = demo.rows(1.0 / static_cast<double>(steps), steps).back();
        return std::abs((last.*way).x - 100 * std::cos(2.0));
    };
    for (const auto way : {&TimeStepDemo::Row::symplectic_euler, &TimeStepDemo::Row::explicit_euler}) {
        EXPECT_NEAR(error(1000, way) / error(2000, way), 2, 0.05);
    }
}

} // namespace
} // namespace evod::viewer
