// Time step demo: a motion with a known exact solution, stepped as a world's bodies are, so that anyone can see what
// the length of a tick does.
//
// The motion is x'' = −ω²x − c·v: a spring (c = 0), damped motion (ω = 0), or both. A step first
// works out v' = v + (−ω²x − c·v)·dt; then
//
//   symplectic Euler  x' = x + v'·dt    a spring's energy goes up and down but stays, while ω·dt < 2
//   explicit Euler    x' = x + v·dt     a spring's energy grows by 1 + ω²dt² in every step, however short
//
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
        double x_px = 0, v_px_s = 0;
    };
    struct System {
        double omega_per_s = 2;   // ω, >= 0
        double damping_per_s = 0; // c, >= 0
        State start{100, 0};
    };
    /// The same moment by each way.
    struct Row {
        double t_s;
        State exact, symplectic_euler, explicit_euler;
    };

    explicit TimeStepDemo(const System& system) : system_{system} {}

    /// The exact solution at t >= 0.
    State exact(double t_s) const;
    State step(State from, double dt_s, EulerMethod method) const;
    /// Of a kilogram, kg px²/s².
    double energy(const State& state) const;

    /// The start and the moments after 1 … step_count steps.
    std::vector<Row> rows(double dt_s, std::size_t step_count) const;

    /// What a spring's energy is multiplied with by explicit Euler in one step.
    double explicit_growth(double dt_s) const;
    /// Whether symplectic Euler stays near the exact solution for ever.
    bool symplectic_is_stable(double dt_s) const;

  private:
    System system_;
};

} // namespace evod::viewer
