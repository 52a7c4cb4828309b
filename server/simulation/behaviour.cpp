#include "server/simulation/behaviour.h"

#include "server/base/assert.h"
#include "server/base/elementary.h"
#include "server/base/instructions.h"

#include <algorithm>
#include <vector>

namespace evod::simulation {

extern const BrainKernels brain_kernels_baseline, brain_kernels_avx2, brain_kernels_avx512;

const BrainKernels& brain_kernels() {
    return base::chosen(brain_kernels_baseline, brain_kernels_avx2, brain_kernels_avx512);
}

namespace {

ChoiceRules choice_rules(const BehaviourRules& rules, const base::RandomKey& key, std::uint32_t tick) {
    return {.always_flee = rules.flee_rule == parameters::FleeRule::Always,
            .lookahead_s = rules.lookahead_s,
            .certain_impulse = rules.certain_impulse,
            .force_per_unit = rules.force_per_unit,
            .pair_counter = key.pair_counter(tick),
            .pair_key = key.pair_key()};
}

BrainColumns brain_columns(LivingOrganisms& living) {
    return {
        .weights = living.weights.data(), .heading = living.heading.data(), .base_health = living.base_health.data()};
}

/// Copies of the columns of a few organisms that OrganismKernels::predict() and BrainKernels::predict() read.
struct FewOrganisms {
    static constexpr std::size_t room = physics::circles_per_block;
    struct View {
        std::array<std::int32_t, room> x{}, y{};
        std::array<float, room> radius{};
        std::array<ItemQuery, room> queries;
        std::array<TwoNearest, room> nearest;

        void search(const Items& items, std::size_t count) {
            items_kernels().two_nearest(items.grid(), queries.data(), nearest.data(), count);
            for (std::size_t k = 0; k < count; ++k) {
                x[k] = nearest[k].x;
                y[k] = nearest[k].y;
            }
        }
        ViewColumns columns() {
            return {.others = nullptr, .x = x.data(), .y = y.data(), .radius = radius.data(), .item_radius = 0};
        }
    };
    std::array<std::int32_t, room> x{}, y{};
    std::array<float, room> velocity_x{}, velocity_y{}, health{}, normal_speed{}, impulse{};
    std::array<std::uint32_t, room> id{};
    std::array<std::int32_t, room> is_hunted{};
    View food, poison;

    void put(std::size_t k, const physics::Circles& bodies, const LivingOrganisms& living, std::uint32_t body) {
        x[k] = bodies.x[body];
        y[k] = bodies.y[body];
        velocity_x[k] = bodies.velocity_x[body];
        velocity_y[k] = bodies.velocity_y[body];
        id[k] = bodies.id[body];
        health[k] = living.health[body] - living.loss_per_tick[body];
        normal_speed[k] = living.normal_speed[body];
        impulse[k] = living.impulse[body];
        food.radius[k] = living.food_radius[body];
        poison.radius[k] = living.poison_radius[body];
        food.queries[k] = {x[k], y[k], food.radius[k]};
        poison.queries[k] = {x[k], y[k], poison.radius[k]};
    }
    OrganismColumns columns() {
        return {.x = x.data(),
                .y = y.data(),
                .velocity_x = velocity_x.data(),
                .velocity_y = velocity_y.data(),
                .id = id.data(),
                .health = health.data(),
                .normal_speed = normal_speed.data(),
                .impulse = impulse.data(),
                .food = food.columns(),
                .poison = poison.columns(),
                .is_hunted = is_hunted.data()};
    }
};

} // namespace

OrganismColumns organism_columns(physics::Circles& bodies, LivingOrganisms& living, Perception& perception,
                                 const Items& food, const Items& poison) {
    OrganismColumns columns{.x = bodies.x.data(),
                            .y = bodies.y.data(),
                            .velocity_x = bodies.velocity_x.data(),
                            .velocity_y = bodies.velocity_y.data(),
                            .body_radius = bodies.radius.data(),
                            .id = bodies.id.data(),
                            .health = living.health.data(),
                            .loss_per_tick = living.loss_per_tick.data(),
                            .normal_speed = living.normal_speed.data(),
                            .impulse = living.impulse.data()};
    perception.add_to(columns, living, food, poison);
    return columns;
}

void live_and_choose(const OrganismColumns& columns, const BehaviourRules& rules, const base::RandomKey& key,
                     std::uint32_t tick, base::Range block, ChosenForces& forces) {
    EVOD_ASSERT(block.begin % physics::lanes_max == 0);
    EVOD_ASSERT(block.begin <= block.end);
    EVOD_ASSERT(block.end - block.begin <= forces.x.size());
    EVOD_ASSERT(rules.certain_impulse > 0);
    organism_kernels().choose(columns, block.begin, block.end, choice_rules(rules, key, tick), forces.x.data(),
                              forces.y.data());
}

SteeringRules steering_rules(const evolution::BrainLayout& layout, const parameters::Parameters& p,
                             const physics::Area& area) {
    const auto float_of = [](double value) { return static_cast<float>(value); };
    return {.inputs = layout.inputs.data(),
            .input_count = static_cast<std::uint32_t>(layout.inputs.size()),
            .hidden_count = layout.hidden_count,
            .weight_count = layout.weight_count(),
            .has_bias = layout.has_bias,
            .is_kinematic = p.locomotion == evolution::Locomotion::Kinematic,
            .force_per_unit = float_of(p.force_per_unit),
            .speed_change = float_of(p.acceleration_max_px_s2 * p.tick_s),
            .turn = float_of(p.turn_rate_max_deg_s / 180 * base::pi * p.tick_s),
            .max_speed = float_of(p.max_speed_px_s),
            .width = area.width,
            .height = area.height};
}

void live_and_steer(const OrganismColumns& columns, LivingOrganisms& living, const SteeringRules& rules,
                    base::Range block, ChosenForces& outcome) {
    EVOD_ASSERT(block.begin % physics::lanes_max == 0);
    EVOD_ASSERT(block.begin <= block.end);
    EVOD_ASSERT(block.end - block.begin <= outcome.x.size());
    EVOD_ASSERT(rules.weight_count == living.weight_count());
    EVOD_ASSERT(rules.input_count >= 1);
    EVOD_ASSERT(rules.input_count <= evolution::brain_inputs_max);
    EVOD_ASSERT(rules.hidden_count <= evolution::brain_hidden_max);
    brain_kernels().steer(columns, brain_columns(living), block.begin, block.end, rules, outcome.x.data(),
                          outcome.y.data());
}

namespace {

/// Copies of the networks of a few organisms, for BrainKernels::predict().
class FewBrains {
  public:
    FewBrains(const LivingOrganisms& living, std::size_t count) : weights_(living.weight_count()) {
        few_.clear(living.weight_count());
        few_.resize(count);
    }
    void put(std::size_t k, const LivingOrganisms& living, std::uint32_t body) {
        for (std::size_t w = 0; w < weights_.size(); ++w) {
            weights_[w] = living.weights[living.first_weight(body) + w * physics::lanes_max];
        }
        few_.put_brain(k, weights_, living.heading[body]);
        few_.base_health[k] = living.base_health[body];
    }
    BrainColumns columns() { return brain_columns(few_); }

  private:
    LivingOrganisms few_;
    std::vector<float> weights_;
};

/// Copies organisms in groups, with what they see, and calls predict(few, first, count) for each group.
template <class Predict>
void for_each_few(FewOrganisms& few, const physics::Circles& bodies, const LivingOrganisms& living, const Items& food,
                  const Items& poison, const Hunt* hunt, std::uint32_t tick,
                  std::span<const std::uint32_t> bodies_asked, Predict&& predict) {
    for (std::size_t begin = 0; begin < bodies_asked.size(); begin += FewOrganisms::room) {
        const std::size_t count = std::min(bodies_asked.size() - begin, FewOrganisms::room);
        for (std::size_t k = 0; k < count; ++k) {
            EVOD_ASSERT(bodies_asked[begin + k] < bodies.size());
            EVOD_ASSERT(!bodies.is_void(bodies_asked[begin + k]));
            few.put(k, bodies, living, bodies_asked[begin + k]);
        }
        few.food.search(food, count);
        few.poison.search(poison, count);
        for (std::size_t k = 0; hunt != nullptr && k < count; ++k) {
            SeenPlaces seen{few.food.x[k], few.food.y[k], few.poison.x[k], few.poison.y[k], 0};
            hunt->look(bodies, living, bodies_asked[begin + k], tick, seen);
            few.food.x[k] = seen.food_x;
            few.food.y[k] = seen.food_y;
            few.poison.x[k] = seen.threat_x;
            few.poison.y[k] = seen.threat_y;
            few.is_hunted[k] = seen.is_hunted;
        }
        predict(begin, count);
    }
}

} // namespace

void predict_intentions(const physics::Circles& bodies, const LivingOrganisms& living, const Items& food,
                        const Items& poison, const Hunt* hunt, const BehaviourRules& rules, const base::RandomKey& key,
                        std::uint32_t tick, std::span<const std::uint32_t> bodies_asked,
                        std::span<Intention> intentions) {
    EVOD_ASSERT(bodies_asked.size() == intentions.size());
    FewOrganisms few;
    ChosenForces forces;
    std::array<std::int32_t, FewOrganisms::room> choices;
    for_each_few(few, bodies, living, food, poison, hunt, tick, bodies_asked,
                 [&](std::size_t begin, std::size_t count) {
                     organism_kernels().predict(few.columns(), 0, count, choice_rules(rules, key, tick),
                                                forces.x.data(), forces.y.data(), choices.data());
                     for (std::size_t k = 0; k < count; ++k) {
                         const auto choice = static_cast<Choice>(choices[k]);
                         const auto [x, y] = choice == Choice::Flee   ? Place{few.poison.x[k], few.poison.y[k]}
                                             : choice == Choice::Seek ? Place{few.food.x[k], few.food.y[k]}
                                                                      : Place{few.x[k], few.y[k]};
                         intentions[begin + k] = {choice, forces.x[k], forces.y[k],
                                                  x,      y,           choice == Choice::Flee && few.is_hunted[k] != 0};
                     }
                 });
}

void predict_steering(const physics::Circles& bodies, const LivingOrganisms& living, const Items& food,
                      const Items& poison, const Hunt* hunt, const SteeringRules& rules, double tick_s,
                      std::uint32_t tick, std::span<const std::uint32_t> bodies_asked,
                      std::span<Intention> intentions) {
    EVOD_ASSERT(bodies_asked.size() == intentions.size());
    EVOD_ASSERT(rules.weight_count == living.weight_count());
    FewOrganisms few;
    ChosenForces outcome;
    FewBrains few_brains{living, std::min(bodies_asked.size(), FewOrganisms::room)};
    for_each_few(few, bodies, living, food, poison, hunt, tick, bodies_asked,
                 [&](std::size_t begin, std::size_t count) {
                     for (std::size_t k = 0; k < count; ++k) {
                         few_brains.put(k, living, bodies_asked[begin + k]);
                     }
                     brain_kernels().predict(few.columns(), few_brains.columns(), 0, count, rules, outcome.x.data(),
                                             outcome.y.data(), nullptr);
                     for (std::size_t k = 0; k < count; ++k) {
                         const std::uint32_t body = bodies_asked[begin + k];
                         const float share =
                             rules.is_kinematic ? 1 / (bodies.inverse_mass[body] * static_cast<float>(tick_s)) : 1;
                         const auto force = [&](float value, float velocity) {
                             return rules.is_kinematic ? (value - velocity) * share : value;
                         };
                         intentions[begin + k] = {Choice::Steer, force(outcome.x[k], few.velocity_x[k]),
                                                  force(outcome.y[k], few.velocity_y[k]), few.x[k], few.y[k]};
                     }
                 });
}

Activations predict_activations(const physics::Circles& bodies, const LivingOrganisms& living, const Items& food,
                                const Items& poison, const Hunt* hunt, const SteeringRules& rules, std::uint32_t tick,
                                std::uint32_t body) {
    EVOD_ASSERT(rules.weight_count == living.weight_count());
    FewOrganisms few;
    ChosenForces outcome;
    FewBrains few_brains{living, 1};
    std::array<float, (evolution::brain_inputs_max + evolution::brain_hidden_max + 2) * physics::lanes_max> neurons;
    for_each_few(few, bodies, living, food, poison, hunt, tick, {&body, 1}, [&](std::size_t, std::size_t) {
        few_brains.put(0, living, body);
        brain_kernels().predict(few.columns(), few_brains.columns(), 0, 1, rules, outcome.x.data(), outcome.y.data(),
                                neurons.data());
    });
    Activations activations;
    std::size_t next = 0;
    const auto read = [&](std::size_t count, std::vector<float>& to) {
        for (std::size_t n = 0; n < count; ++n) {
            to.push_back(neurons[next++ * physics::lanes_max]);
        }
    };
    read(rules.input_count, activations.inputs);
    read(rules.hidden_count, activations.hidden);
    read(2, activations.outputs);
    return activations;
}

} // namespace evod::simulation
