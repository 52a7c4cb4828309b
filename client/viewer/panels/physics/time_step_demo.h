// Time step demo: steps a motion with a known exact solution by the integrators that worlds use, to show the effect of
// the tick length.
//
// The motion is x'' = a − ω²x − c·v: a spring (a = c = 0), damped motion (a = ω = 0), both (a = 0), or constant
// acceleration (ω = c = 0). A step first computes v' = v + (a − ω²x − c·v)·dt; then
//
//   symplectic Euler  x' = x + v'·dt    a spring's energy oscillates but stays bounded if ω·dt < 2
//   explicit Euler    x' = x + v·dt     a spring's energy grows by the factor 1 + ω²dt² in every step, however short
//
// At constant acceleration the position error after t seconds is +½·a·t·dt or −½·a·t·dt, and v is exact.
//
// Units        Lengths have the unit of the start: px for springs and damped motion, m for constant acceleration.
// Owner        PhysicsPanel.
// Threads      none; pure.
// Source       Hairer, Lubich & Wanner 2006, Geometric Numerical Integration, I.1.
#pragma once

#include <cstddef>
#include <vector>

namespace evod::viewer {

enum class EulerMethod { SymplecticEuler, ExplicitEuler };

class TimeStepDemo {
  public:
    struct State {
        double x = 0, v = 0; // position, velocity
    };
    struct System {
        double omega_per_s = 2;   // ω, >= 0
        double damping_per_s = 0; // c, >= 0
        State start{100, 0};
        double acceleration = 0; // a; not 0 only if omega_per_s = damping_per_s = 0
    };
    /// Position and velocity at one time, from the exact solution and from each integrator.
    struct Row {
        double t_s;
        State exact, symplectic_euler, explicit_euler;
    };

    explicit TimeStepDemo(const System& system) : system_{system} {}

    /// Returns the exact solution at t >= 0.
    State exact(double t_s) const;
    State step(State from, double dt_s, EulerMethod method) const;
    /// Returns the energy of a body of 1 kg in this state on the spring, if there is one.
    double energy(const State& state) const;

    /// Returns step_count + 1 rows. Row 0 is the start; row n is the state after n steps.
    std::vector<Row> rows(double dt_s, std::size_t step_count) const;

    /// Returns the factor by which one step of explicit Euler multiplies a spring's energy.
    double explicit_growth(double dt_s) const;
    /// Returns whether the error of symplectic Euler stays bounded for ever.
    bool symplectic_is_stable(double dt_s) const;

  private:
    System system_;
};

} // namespace evod::viewer
