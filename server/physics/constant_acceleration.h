// Constant acceleration: moves one body from rest by the steps of a world, to compare an integrator with the exact
// solution x = ½at², v = at. Without damping, with t = n·dt:
//
//   symplectic Euler  x = ½at² + ½·a·t·dt      explicit Euler  x = ½at² − ½·a·t·dt      v = at for both
//
// Bounds   compared with these formulas, rounding to float and to 1/4096 px changes a speed by at most the fraction
//          (n + 3)·2⁻²⁴, and a position by at most the fraction (n + 5)·2⁻²⁴ plus n·2⁻²³ m.
// Threads  none; pure.
// Source   Hairer, Lubich & Wanner 2006, Geometric Numerical Integration, I.1.
#pragma once

#include "server/physics/integrators.h"

namespace evod::physics {

struct StraightMotion {
    double position_m = 0, speed_m_s = 0;
};

/// Returns the state of a body of 1 kg after tick_count ticks. It starts at 0 from rest; there is no damping.
///
/// acceleration_m_s2  so that the body moves less than 100 m.
StraightMotion accelerate_from_rest(Integrator integrator, double acceleration_m_s2, double tick_s, int tick_count);

} // namespace evod::physics
