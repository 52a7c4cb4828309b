#include "client/viewer/panels/physics/time_step_demo.h"

#include <cmath>

namespace evod::viewer {

TimeStepDemo::State TimeStepDemo::exact(double t) const {
    // The exact position is x = e^(−h·t)·(x0·C + (v0 + h·x0)·S) with h = c/2. The pair (C, S) is (cos wt, sin wt / w),
    // (cosh wt, sinh wt / w) or (1, t).
    const double h = system_.damping_per_s / 2, square = system_.omega_per_s * system_.omega_per_s - h * h;
    const auto [x0, v0] = system_.start;
    const double w = std::sqrt(std::abs(square));
    double c = 1, s = t;
    if (w * t > 1e-6) {
        c = square > 0 ? std::cos(w * t) : std::cosh(w * t);
        s = (square > 0 ? std::sin(w * t) : std::sinh(w * t)) / w;
    }
    const double fading = std::exp(-h * t), b = v0 + h * x0;
    // The velocity is v = x', with C' = −square·S and S' = C.
    const double a = system_.acceleration;
    return {fading * (x0 * c + b * s) + a * t * t / 2,
            fading * (b * c - square * x0 * s) - h * fading * (x0 * c + b * s) + a * t};
}

TimeStepDemo::State TimeStepDemo::step(State from, double dt, EulerMethod method) const {
    const double omega = system_.omega_per_s;
    const double v = from.v + (system_.acceleration - omega * omega * from.x - system_.damping_per_s * from.v) * dt;
    return {from.x + (method == EulerMethod::SymplecticEuler ? v : from.v) * dt, v};
}

double TimeStepDemo::energy(const State& state) const {
    const double omega = system_.omega_per_s;
    return (state.v * state.v + omega * omega * state.x * state.x) / 2;
}

std::vector<TimeStepDemo::Row> TimeStepDemo::rows(double dt, std::size_t step_count) const {
    std::vector<Row> rows{{0, system_.start, system_.start, system_.start}};
    for (std::size_t n = 1; n <= step_count; ++n) {
        const Row& last = rows.back();
        const double t = static_cast<double>(n) * dt;
        rows.push_back({t, exact(t), step(last.symplectic_euler, dt, EulerMethod::SymplecticEuler),
                        step(last.explicit_euler, dt, EulerMethod::ExplicitEuler)});
    }
    return rows;
}

double TimeStepDemo::explicit_growth(double dt) const {
    const double omega = system_.omega_per_s;
    return 1 + omega * omega * dt * dt;
}

bool TimeStepDemo::symplectic_is_stable(double dt) const {
    // Symplectic Euler is stable if the roots of z² − (2 − ω²dt² − c·dt)·z + 1 − c·dt lie within the unit circle (Jury
    // 1962).
    const double omega = system_.omega_per_s, c = system_.damping_per_s * dt, k = omega * omega * dt * dt;
    return k + 2 * c < 4 && c < 2;
}

} // namespace evod::viewer
