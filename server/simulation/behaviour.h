// Behaviour: what each organism sees, and the force with which it answers.
//
// The nearest food within food_radius and the nearest poison within poison_radius are seen, centre to centre. Seen
// poison is fled, with chance min(1, impulse / certain_impulse), if it is nearer than the nearest food seen
// (FleeRule::Always: whatever the food): a force straight away from it. Otherwise seen food is steered to: a force
// along (food − position − velocity · lookahead). Otherwise the organism wanders in a fresh uniform direction. Where
// the direction has no length, it is random.
//
// Threads      ranges of organisms are done side by side; each organism writes its own force.
// Determinism  everything is seen at the positions of the tick's start; the draws of an organism are keyed by its id
//              and the tick.
#pragma once

#include "server/base/random.h"
#include "server/parameters/parameters.h"
#include "server/physics/bodies.h"
#include "server/simulation/items.h"
#include "server/simulation/living.h"
#include "server/simulation/organism_kernels.h"
#include "server/simulation/sight.h"

#include <array>
#include <span>

namespace evod::simulation {

struct BehaviourRules {
    parameters::FleeRule flee_rule;
    float lookahead_s;
    float certain_impulse; // gene value from which fleeing is certain; the chance is impulse over this
    float force_per_unit;  // kg px/s² per gene unit
};

/// What kernels take. Valid until columns grow or are reordered.
OrganismColumns organism_columns(physics::Circles& bodies, Living& living, Sight& sight, const Items& food,
                                 const Items& poison);

/// What the organisms of one block answer with, kg px/s².
struct ChosenForces {
    std::array<float, physics::circles_per_block> x, y;
};

/// The loss of health that a tick costs, and the choice of the organisms of a block, whose views are good.
void live_and_choose(const OrganismColumns& columns, const BehaviourRules& rules, const base::RandomKey& key,
                     std::uint32_t tick, base::Range block, ChosenForces& forces);

/// What an organism is about to do.
struct Intention {
    Choice choice = Choice::None;                   // None: there is no such organism
    float force_x = 0, force_y = 0;                 // kg px/s²
    physics::Coordinate target_x = 0, target_y = 0; // of the food or poison; its own place where it wanders
};

/// What the bodies `who` would choose in `tick` if nothing reappeared before it; changes nothing. Not void ones.
/// intentions  shape (who).
void foresee(const physics::Circles& bodies, const Living& living, const Items& food, const Items& poison,
             const BehaviourRules& rules, const base::RandomKey& key, std::uint32_t tick,
             std::span<const std::uint32_t> who, std::span<Intention> intentions);

} // namespace evod::simulation
