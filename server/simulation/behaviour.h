// Behaviour: computes what each organism sees, and the force with which it responds.
//
// An organism sees the nearest food within food_radius and the nearest poison within poison_radius, centre to centre.
// 1. It flees from seen poison with probability min(1, impulse / certain_impulse), if the poison is nearer than the
// nearest seen food (FleeRule::Always: regardless of food). The force points straight away from the poison.
// 2. Otherwise it steers to seen food: a force along (food − position − velocity · lookahead).
// 3. Otherwise it wanders: a force in a new uniform direction. It also wanders if the direction in 1 or 2 has length 0.
//
// In worlds whose controller is network, a neural network steers each organism instead (brain_kernels.h). It first
// turns the organism. Newtonian: a force then acts along the new heading, backward if negative. Kinematic: the speed
// along the heading changes instead; it stays within 0 and the maximum speed.
//
// Threads      ranges of organisms are processed in parallel; each organism writes its own force.
// Determinism  all positions are those at the start of the tick; the draws of an organism are keyed by its id and the
//              tick.
#pragma once

#include "server/base/random.h"
#include "server/evolution/brain_layout.h"
#include "server/parameters/model_parameters.h"
#include "server/physics/bodies.h"
#include "server/simulation/brain_kernels.h"
#include "server/simulation/hunt.h"
#include "server/simulation/items.h"
#include "server/simulation/living_organisms.h"
#include "server/simulation/organism_kernels.h"
#include "server/simulation/perception.h"

#include <array>
#include <span>
#include <vector>

namespace evod::simulation {

struct BehaviourRules {
    parameters::FleeRule flee_rule;
    float lookahead_s;
    float certain_impulse; // gene value from which fleeing is certain; the probability is impulse / certain_impulse
    float force_per_unit;  // kg px/s² per gene unit
};

/// Returns pointers to the columns that kernels process. The pointers are valid until a column grows or is reordered.
OrganismColumns organism_columns(physics::Circles& bodies, LivingOrganisms& living, Perception& perception,
                                 const Items& food, const Items& poison);

/// The forces that the organisms of one block choose, kg px/s².
struct ChosenForces {
    std::array<float, physics::circles_per_block> x, y;
};

/// For each organism of a block, subtracts the health that a tick costs and chooses a force. Call Perception::search()
/// for the block first.
void live_and_choose(const OrganismColumns& columns, const BehaviourRules& rules, const base::RandomKey& key,
                     std::uint32_t tick, base::Range block, ChosenForces& forces);

/// Returns the rules by which networks of this layout steer. `layout` must outlive the result.
SteeringRules steering_rules(const evolution::BrainLayout& layout, const parameters::Parameters& parameters,
                             const physics::Area& area);

/// For each organism of a block, subtracts the health that a tick costs, and lets its network steer. Call
/// Perception::search() for the block first.
///
/// outcome  receives the forces on the organisms; if they are kinematic, their new velocities, px/s.
void live_and_steer(const OrganismColumns& columns, LivingOrganisms& living, const SteeringRules& rules,
                    base::Range block, ChosenForces& outcome);

/// What an organism will do in the next tick.
struct Intention {
    Choice choice = Choice::None;                   // None: the organism is dead or has no body
    float force_x = 0, force_y = 0;                 // kg px/s²
    physics::Coordinate target_x = 0, target_y = 0; // position of the item or organism; otherwise its own position
    bool flees_predator = false;                    // Flee: from a predator, not from poison
};

/// Predicts what the organisms of `bodies_asked` will choose in `tick` if no item reappears before it. Changes nothing.
/// `bodies_asked` must contain no placeholders of dead organisms.
///
/// hunt        where the organisms of both species are; nullptr if there are no predators.
/// intentions  receives one Intention for each element of bodies_asked.
void predict_intentions(const physics::Circles& bodies, const LivingOrganisms& living, const Items& food,
                        const Items& poison, const Hunt* hunt, const BehaviourRules& rules, const base::RandomKey& key,
                        std::uint32_t tick, std::span<const std::uint32_t> bodies_asked,
                        std::span<Intention> intentions);

/// As predict_intentions(), for organisms with a network. If they are kinematic, the predicted force is the one that
/// would change the velocity of the body as the network does.
void predict_steering(const physics::Circles& bodies, const LivingOrganisms& living, const Items& food,
                      const Items& poison, const Hunt* hunt, const SteeringRules& rules, double tick_s,
                      std::uint32_t tick, std::span<const std::uint32_t> bodies_asked, std::span<Intention> intentions);

/// The neurons of a network at the start of the next tick.
struct Activations {
    std::vector<float> inputs, hidden, outputs;
};
/// Computes the activations with which the network of an organism will steer it if no item reappears before the next
/// tick. `body` must not be the placeholder of a dead organism.
Activations predict_activations(const physics::Circles& bodies, const LivingOrganisms& living, const Items& food,
                                const Items& poison, const Hunt* hunt, const SteeringRules& rules, std::uint32_t tick,
                                std::uint32_t body);

} // namespace evod::simulation
