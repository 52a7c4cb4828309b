// Integrators: how acceleration changes the velocity of a body in a tick, and which velocity moves the body.
//
//   symplectic Euler  v' = (v + a·dt)·d             x' = x + v'·dt     (d = share kept by damping in a tick)
//   explicit Euler    v' = (v + a·dt)·d             x' = x + v·dt      (v also contains this tick's collision impulses)
//   backward Euler    v' = (v + a·dt)/(1 + c·dt)    x' = x + v'·dt     (c = damping rate; c = 0: symplectic Euler)
//
// Source  Hairer, Lubich & Wanner 2006, Geometric Numerical Integration, I.1.
#pragma once

#include <cstdint>

namespace evod::physics {

enum class Integrator : std::uint8_t { SymplecticEuler, ExplicitEuler, BackwardEuler };

/// The constants of a tick, computed once.
struct Integration {
    Integrator integrator = Integrator::SymplecticEuler;
    float tick_s = 1.0f / 60;
    float velocity_kept = 1; // factor by which damping multiplies every velocity in a tick
};

/// Returns the constants of a tick.
///
/// damping_rate  in 1/s, >= 0: after t seconds the share e^(−damping_rate·t) of a velocity is left.
Integration integration(Integrator integrator, double tick_s, double damping_rate);

/// Returns the damping rate, 1/s, that leaves the share `share_kept` of a velocity after 1/60 s; share_kept in (0, 1].
double damping_rate(double share_kept);

/// Returns the velocity after acceleration and damping.
inline float accelerate(const Integration& i, float velocity, float acceleration) {
    return (velocity + acceleration * i.tick_s) * i.velocity_kept;
}

} // namespace evod::physics
