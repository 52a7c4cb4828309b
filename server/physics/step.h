// Step: the physics of one tick, in this order:
// accumulated forces → velocity; damping; detect and resolve collisions; limit speeds; velocity → position; keep inside
// the walls; clear forces.
//
// Owner        an island; keeps its working memory warm between ticks.
// Determinism  see contacts.h; everything else is per body.
#pragma once

#include "server/base/executor.h"
#include "server/physics/bodies.h"
#include "server/physics/contacts.h"
#include "server/physics/integrators.h"

#include <cstdint>

namespace evod::physics {

struct StepParameters {
    Integration integration;
    float restitution = 0.8f;
    float max_speed_px_s = 600;
};

struct StepCounts {
    std::uint64_t too_fast = 0;      // bodies that moved more than their radius, or least half side
    std::uint64_t speed_limited = 0; // bodies whose speed was cut to the greatest allowed
};

class Stepper {
  public:
    StepCounts step(Circles& circles, Boxes& boxes, const Area& area, const StepParameters& parameters,
                    base::Executor& executor);

  private:
    Contacts contacts_;
    std::vector<float> drift_x_, drift_y_; // explicit Euler: velocity at the tick's start − velocity after acceleration
};

} // namespace evod::physics
