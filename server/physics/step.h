// Step: the physics of one tick, in this order:
// accumulated forces → velocity; damping; detect and resolve collisions; limit speeds; velocity → position; keep inside
// the walls. Forces act for one tick.
//
// Owner        an island; it keeps the working memory between ticks.
// Threads      blocks of circles are accelerated, tested for contacts and moved in parallel. A caller that has more
//              work per block calls the parts of the step in its own loops.
// Determinism  contacts.h states the order of contacts; everything else is independent for each body.
#pragma once

#include "server/base/executor.h"
#include "server/physics/bodies.h"
#include "server/physics/broad_phase.h"
#include "server/physics/contacts.h"
#include "server/physics/integrators.h"
#include "server/physics/motion_kernels.h"

#include <cstdint>
#include <vector>

namespace evod::physics {

struct StepParameters {
    Integration integration;
    float restitution = 0.8f;
    float max_speed_px_s = 600;
};

struct StepCounts {
    std::uint64_t too_fast = 0;      // bodies that moved more than their radius or least half side
    std::uint64_t speed_limited = 0; // bodies whose speed was reduced to the maximum
};

class Stepper {
  public:
    /// Performs one tick. `force` contains the force on each circle, padded like the columns.
    StepCounts step(Circles& circles, Boxes& boxes, const Area& area, const StepParameters& parameters,
                    const Forces& force, base::Executor& executor);

    // The parts of step(), in the order in which they are called.

    /// The list of near pairs. The caller renews it when its stale() returns true.
    NearPairs& near() { return near_; }
    const NearPairs& near() const { return near_; }
    void begin(Circles& circles, const Boxes& boxes, const Area& area, const StepParameters& parameters);
    /// For one block of circles: forces → velocities, damping, bounces off walls; then finds the contacts of the block.
    /// Blocks may be processed in parallel.
    /// force  the forces on the circles of the block.
    void accelerate(Circles& circles, std::size_t block, const Forces& force);
    /// Applies damping and bounces off walls to the boxes, and finds their contacts; then resolves all contacts.
    void collide(Circles& circles, Boxes& boxes, base::Executor& executor);
    /// Moves one block of circles by their velocities. Blocks may be processed in parallel.
    void move(Circles& circles, std::size_t block);
    /// Moves the boxes by their velocities.
    StepCounts finish(Boxes& boxes);

  private:
    MotionColumns columns(Circles& circles);
    bool is_explicit() const { return parameters_.integration.integrator == Integrator::ExplicitEuler; }

    StepParameters parameters_;
    Area area_;
    MotionRules rules_{};
    NearPairs near_;
    Contacts contacts_;
    base::Column<float> drift_x_, drift_y_, box_drift_x_, box_drift_y_; // see MotionColumns
    std::vector<MoveCounts> counts_of_block_;
};

} // namespace evod::physics
