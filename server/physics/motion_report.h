// Motion report: how fast bodies move and how deeply they overlap, measured between two ticks. It shows whether a tick
// is short enough for the speeds.
//
// Determinism  the terms of sums are rounded to multiples of 1/65536, which doubles add exactly up to 2^37. Equal
//              states therefore give equal reports, in whatever order circles are stored.
// Cost         O(n); a little more if the list of near pairs is stale, because the report then creates its own list.
#pragma once

#include "server/physics/bodies.h"
#include "server/physics/broad_phase.h"

#include <cstdint>

namespace evod::physics {

/// The motion of all bodies. The extent of a body is its radius or its least half side.
struct MotionReport {
    std::uint32_t body_count = 0;              // bodies that can move
    double kinetic_energy = 0;                 // kg px²/s²
    double momentum_x = 0, momentum_y = 0;     // kg px/s
    std::uint32_t touching_count = 0;          // pairs of bodies, at least one of which can move
    double deepest_overlap_px = 0;             // greatest overlap of two bodies, or of a movable body and a wall
    double deepest_overlap_share = 0;          // greatest overlap, as a share of the smaller body's extent
    double fastest_px_s = 0, fastest_step = 0; // fastest_step: greatest movement in a tick, as a share of the extent
    double strip_px = 0;                       // height of the strips in which contacts are searched
};

/// Measures the motion of all bodies. `near` contains their near pairs, and may be stale.
MotionReport report_motion(const Circles& circles, const Boxes& boxes, const Area& area, double tick_s,
                           const NearPairs& near);

} // namespace evod::physics
