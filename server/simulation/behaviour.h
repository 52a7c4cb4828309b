// Behaviour: what each organism sees, and the force with which it answers.
//
// Threads      organisms are looked at in blocks side by side; each writes its own force.
// Determinism  everything is seen at the positions of the tick's start; the draws of an organism are keyed by its id
// and
//              the tick, and made only where they are needed.
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"
#include "server/physics/bodies.h"
#include "server/simulation/items.h"
#include "server/simulation/living.h"
#include "server/simulation/parameters.h"

#include <vector>

namespace evod::simulation {

/// What was seen at a tick's start, by body index: for feeding, which need not look where nothing can be reached.
struct Sight {
    std::vector<physics::Coordinate> x, y;             // where the organism was
    std::vector<float> food_distance, poison_distance; // px; that nothing of the kind was nearer than
};

struct BehaviourRules {
    FleeRule flee_rule;
    float lookahead_s;
    float certain_impulse; // gene value from which fleeing is certain; the chance is impulse over this
    float force_per_unit;  // kg px/s² per gene unit
};

/// Perception and choice of every living organism; adds its force to its body.
///
/// The nearest food within food_radius and the nearest poison within poison_radius are seen, centre to centre. Seen
/// poison is fled, with chance min(1, impulse / certain_impulse), if it is nearer than the nearest food seen
/// (FleeRule::Always: whatever the food): a force straight away from it. Otherwise seen food is steered to: a force
/// along (food − position − velocity · lookahead). Otherwise the organism wanders in a fresh uniform direction. Where
/// the direction has no length, it is random.
void perceive_and_choose(const Living& living, const Items& food, const Items& poison, const BehaviourRules& rules,
                         const base::RandomKey& key, std::uint32_t tick, physics::Circles& bodies, Sight& sight,
                         base::Executor& executor);

} // namespace evod::simulation
