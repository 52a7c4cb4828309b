#include "server/simulation/behaviour.h"

namespace evod::simulation {

OrganismColumns organism_columns(physics::Circles& bodies, Living& living, Sight& sight, const Items& food,
                                 const Items& poison) {
    OrganismColumns columns{.x = bodies.x.data(),
                            .y = bodies.y.data(),
                            .velocity_x = bodies.velocity_x.data(),
                            .velocity_y = bodies.velocity_y.data(),
                            .body_radius = bodies.radius.data(),
                            .id = bodies.id.data(),
                            .health = living.health.data(),
                            .loss_per_tick = living.loss_per_tick.data(),
                            .normal_speed = living.normal_speed.data(),
                            .impulse = living.impulse.data(),
                            .seen_x = nullptr,
                            .seen_y = nullptr,
                            .food = {},
                            .poison = {}};
    sight.add_to(columns, living, food, poison);
    return columns;
}

void live_and_choose(const OrganismColumns& columns, const BehaviourRules& rules, const base::RandomKey& key,
                     std::uint32_t tick, base::Range block, ChosenForces& forces) {
    organism_kernels().choose(columns, block.begin, block.end,
                              {.always_flee = rules.flee_rule == FleeRule::Always,
                               .lookahead_s = rules.lookahead_s,
                               .certain_impulse = rules.certain_impulse,
                               .force_per_unit = rules.force_per_unit,
                               .pair_counter = key.pair_counter(tick),
                               .pair_key = key.pair_key()},
                              forces.x.data(), forces.y.data());
}

} // namespace evod::simulation
