// Motion report: how bodies move and overlap, measured between two ticks, for whoever judges whether a tick is short
// enough for its speeds.
//
// Determinism  what is summed are whole numbers of 1/65536, which doubles add exactly up to 2^37: equal scenes give
//              equal reports, in whatever order their circles lie.
// Cost         O(n); a little more where the near pairs are worn, for they are found afresh then.
#pragma once

#include "server/physics/bodies.h"
#include "server/physics/broad_phase.h"

#include <cstdint>

namespace evod::physics {

struct MotionReport {
    std::uint32_t body_count = 0;              // that can move
    double kinetic_energy = 0;                 // kg px²/s²
    double momentum_x = 0, momentum_y = 0;     // kg px/s
    std::uint32_t touching_count = 0;          // pairs of bodies, at least one of which can move
    double deepest_overlap_px = 0;             // of two bodies, or of one that can move and a wall
    double deepest_overlap_share = 0;          // the most, of the smaller one's radius or least half side
    double fastest_px_s = 0, fastest_step = 0; // the most that a body moves in a tick, of its radius or least half side
    double strip_px = 0;                       // height of the strips in which contacts are looked for
};

/// near  of these bodies; worn or not.
MotionReport report_motion(const Circles& circles, const Boxes& boxes, const Area& area, double tick_s,
                           const NearPairs& near);

} // namespace evod::physics
