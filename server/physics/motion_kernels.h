// Motion kernels: what becomes of the velocities and positions of circles in a tick, several circles at once.
//
// Determinism  per circle; compiled for two sets of instructions, with the same bits (base/instructions.h).
#pragma once

#include <cstddef>
#include <cstdint>

namespace evod::physics {

/// Columns as in Circles, padded to whole lanes.
struct MotionColumns {
    std::int32_t *x, *y;
    float *velocity_x, *velocity_y;
    const float *inverse_mass, *radius;
    float *drift_x, *drift_y; // explicit Euler: what the velocity was more before it changed; else nullptr
    const std::int32_t *anchor_x, *anchor_y; // see MoveCounts::strayed_square
};

/// What acts on a block of circles in one tick, kg px/s²; padded as columns are, 0 for what is void.
struct Forces {
    const float *x, *y;
};

struct MotionRules {
    float tick_s;
    float velocity_kept;
    float restitution;
    float max_speed;            // px/s
    std::int32_t width, height; // of the area, units
};

struct MoveCounts {
    std::uint64_t too_fast = 0, speed_limited = 0; // as StepCounts
    float strayed_square = 0;                      // px²; of the greatest distance from an anchor
};

struct MotionKernels {
    /// Force → velocity, damping, and the bounce off a wall that is touched by a circle that heads outward.
    /// force  of the circles from `begin` on.
    void (*accelerate)(const MotionColumns& columns, const Forces& force, std::size_t begin, std::size_t end,
                       const MotionRules& rules);
    /// Limits speeds; velocity → position; puts back what is beyond a wall, and bounces it if it still heads outward.
    MoveCounts (*move)(const MotionColumns& columns, std::size_t begin, std::size_t end, const MotionRules& rules);
    // begin is a multiple of lanes_max; up to lanes_max − 1 void circles beyond `end` are gone through too.
};

/// Those for the instructions in use.
const MotionKernels& motion_kernels();

} // namespace evod::physics
