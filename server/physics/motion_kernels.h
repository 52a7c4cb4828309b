// Motion kernels: update the velocities and positions of circles in a tick, several circles at once.
//
// Determinism  each circle is computed independently. The kernels are compiled for several sets of instructions, which
//              give the same bits (base/instructions.h).
#pragma once

#include <cstddef>
#include <cstdint>

namespace evod::physics {

/// Pointers to the columns of Circles and to others of the same length, padded to full vectors.
struct MotionColumns {
    std::int32_t *x, *y;
    float *velocity_x, *velocity_y;
    const float *inverse_mass, *radius;
    float *drift_x, *drift_y;                // explicit Euler: old velocity − new velocity; otherwise nullptr
    const std::int32_t *anchor_x, *anchor_y; // positions from which MoveCounts::displacement_square is measured
};

/// The forces on a block of circles in one tick, kg px/s²; padded like the columns, 0 for void circles.
struct Forces {
    const float *x, *y;
};

struct MotionRules {
    float tick_s;
    float velocity_kept;
    float restitution;
    float max_speed;            // px/s
    std::int32_t width, height; // size of the area, units
};

struct MoveCounts {
    std::uint64_t too_fast = 0, speed_limited = 0; // as in StepCounts
    float displacement_square = 0;                 // squared distance of the circle furthest from its anchor, px²
};

struct MotionKernels {
    /// Applies force and damping to velocities, and bounces a circle off a wall that it touches if it moves outward.
    /// force  the forces on the circles from `begin` on: element 0 is for circle `begin`.
    void (*accelerate)(const MotionColumns& columns, const Forces& force, std::size_t begin, std::size_t end,
                       const MotionRules& rules);
    /// Limits speeds, and applies velocities to positions. Moves circles that are beyond a wall back inside;
    /// bounces them off the wall if they still move outward.
    MoveCounts (*move)(const MotionColumns& columns, std::size_t begin, std::size_t end, const MotionRules& rules);
    // Kernels process whole vectors: `begin` must be a multiple of lanes_max, and up to lanes_max − 1 circles after
    // `end`, which are padding, are processed too.
};

/// Returns the kernels for the instruction set in use (base/instructions.h).
const MotionKernels& motion_kernels();

} // namespace evod::physics
