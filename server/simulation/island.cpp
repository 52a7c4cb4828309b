#include "server/simulation/island.h"

#include "server/base/assert.h"
#include "server/simulation/fitness.h"
#include "server/simulation/placement.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace evod::simulation {
namespace {

// Kinds of entity in the state hash; part of a run's identity.
enum HashKind : std::uint32_t { OrganismKind = 1, FoodKind = 2, PoisonKind = 3, CrateKind = 4, ChromosomeKind = 5 };

constexpr std::size_t organisms_per_block = 1024;

physics::StepParameters step_parameters(const Parameters& p) {
    constexpr physics::Integrator integrators[] = {
        physics::Integrator::SymplecticEuler, physics::Integrator::ExplicitEuler, physics::Integrator::BackwardEuler};
    return {.integration = physics::integration(integrators[static_cast<std::size_t>(p.integrator)], p.tick_s,
                                                physics::damping_rate(p.damping)),
            .restitution = static_cast<float>(p.restitution),
            .max_speed_px_s = static_cast<float>(p.max_speed_px_s)};
}

ItemRules item_rules(const Parameters& p) {
    // A little less, so that 23 sixtieths are 23 ticks of a sixtieth however they are rounded.
    const double ticks = std::ceil(p.respawn_s / p.tick_s - 1e-6);
    return {.placement = base::Purpose::FoodPlacement,
            .respawn_purpose = base::Purpose::FoodRespawn,
            .kind = FoodKind,
            .count = 0,
            .radius_px = static_cast<float>(p.item_radius_px),
            .respawn = p.respawn,
            .respawn_ticks = static_cast<std::uint32_t>(std::clamp(ticks, 1.0, 1e9))};
}

} // namespace

void Island::begin_generation(const Parameters& parameters, std::uint64_t generation, evolution::NextGeneration bred) {
    born_ = std::move(bred);
    behaviour_key_ = base::RandomKey{seed_, base::Purpose::Behaviour, index_, generation};
    fate_.begin_generation(static_cast<std::size_t>(born_.genes.cols()));
    counts_ = {};
    living_.clear();
    bodies_.clear();
    boxes_.clear();

    born_hash_ = {};
    for (Eigen::Index id = 0; id < born_.genes.cols(); ++id) {
        const float* genes = born_.genes.data() + id * evolution::gene_count;
        born_hash_ += base::EntityHash{ChromosomeKind, static_cast<std::uint64_t>(id)}
                          .add(genes[0], genes[1])
                          .add(genes[2], genes[3])
                          .add(genes[4], genes[5])
                          .finish();
    }
    hash_ = born_hash_;
    if (parameters.fitness == FitnessFunction::Life)
        place(parameters, generation);
}

void Island::place(const Parameters& parameters, std::uint64_t generation) {
    const IslandPlan plan = island_plan(parameters);
    area_ = {physics::to_units(plan.width_px), physics::to_units(plan.height_px)};
    step_parameters_ = step_parameters(parameters);

    PlacedBoxes placed = place_boxes({.obstacle_count = parameters.obstacle_count,
                                      .crate_count = parameters.crate_count,
                                      .obstacle_half_size_px = static_cast<float>(parameters.obstacle_size_px / 2),
                                      .crate_half_size_px = static_cast<float>(parameters.crate_size_px / 2),
                                      .crate_mass_kg = static_cast<float>(parameters.crate_mass_kg)},
                                     seed_, index_, generation, area_);
    obstacles_ = std::move(placed.obstacles);
    boxes_ = std::move(placed.crates);
    crate_count_ = static_cast<std::uint32_t>(boxes_.size());
    for (std::size_t i = 0; i < obstacles_.size(); ++i)
        boxes_.add(obstacles_.x[i], obstacles_.y[i], obstacles_.half_width[i], obstacles_.half_height[i], 0);

    const auto organisms = static_cast<std::size_t>(born_.genes.cols());
    std::vector<float> radius(organisms);
    const auto shape_of = [&](std::size_t id) {
        return body_shape(born_.genes(evolution::BodySize, static_cast<Eigen::Index>(id)), parameters);
    };
    for (std::size_t id = 0; id < organisms; ++id)
        radius[id] = shape_of(id).radius_px;
    const std::vector<Place> places = place_circles(radius, seed_, index_, generation, area_, boxes_);
    for (std::size_t id = 0; id < organisms; ++id) {
        bodies_.add(static_cast<std::uint32_t>(id), places[id].x, places[id].y, radius[id], shape_of(id).mass_kg);
        living_.add(born_.genes.col(static_cast<Eigen::Index>(id)), parameters);
    }

    ItemRules rules = item_rules(parameters);
    rules.count = plan.food_count;
    food_.begin_generation(rules, seed_, index_, generation, area_, obstacles_);
    rules.count = plan.poison_count;
    rules.placement = base::Purpose::PoisonPlacement;
    rules.respawn_purpose = base::Purpose::PoisonRespawn;
    rules.kind = PoisonKind;
    poison_.begin_generation(rules, seed_, index_, generation, area_, obstacles_);
}

void Island::advance_tick(const Parameters& parameters, std::uint32_t tick, base::Executor& executor) {
    food_.reappear(tick, obstacles_);
    poison_.reappear(tick, obstacles_);
    for (std::size_t i = 0; i < living_.size(); ++i)
        living_.health[i] -= living_.loss_per_tick[i];
    perceive_and_choose(living_, food_, poison_,
                        {.flee_rule = parameters.flee_rule,
                         .lookahead_s = static_cast<float>(parameters.steering_lookahead_s),
                         .certain_impulse = static_cast<float>(parameters.flee_certain_impulse),
                         .force_per_unit = static_cast<float>(parameters.force_per_unit)},
                        behaviour_key_, tick, bodies_, sight_, executor);
    const physics::StepCounts step = stepper_.step(bodies_, boxes_, area_, step_parameters_, executor);
    counts_.too_fast_count += step.too_fast;
    counts_.speed_limit_count += step.speed_limited;
    feed(parameters, tick, executor);
    bury_the_dead(tick);
    update_hash(executor);
}

void Island::feed(const Parameters& parameters, std::uint32_t tick, base::Executor& executor) {
    // All food before all poison; equal items, so that the order among each does not matter.
    const auto food_health = static_cast<float>(parameters.food_health);
    for (const Meal& meal : feeding_.meals(bodies_, food_, sight_, sight_.food_distance, executor)) {
        float& health = living_.health[meal.body];
        health = std::min(health + food_health, living_.health_cap[meal.body]);
        food_.consume(meal.item, tick);
        ++fate_.food_eaten[bodies_.id[meal.body]];
        ++counts_.food_eaten;
    }
    const auto poison_harm = static_cast<float>(parameters.poison_harm);
    for (const Meal& meal : feeding_.meals(bodies_, poison_, sight_, sight_.poison_distance, executor)) {
        living_.health[meal.body] -= poison_harm;
        poison_.consume(meal.item, tick);
        ++fate_.poison_eaten[bodies_.id[meal.body]];
        ++counts_.poison_eaten;
        living_.poisoned_tick[meal.body] = tick;
    }
}

void Island::bury_the_dead(std::uint32_t tick) {
    const auto dead = [this](std::size_t i) { return living_.health[i] <= 0; };
    std::size_t i = 0;
    while (i < living_.size() && !dead(i))
        ++i;
    if (i == living_.size())
        return;
    keep_.assign(living_.size(), 1);
    for (; i < living_.size(); ++i) {
        if (!dead(i))
            continue;
        keep_[i] = 0;
        const std::uint32_t id = bodies_.id[i];
        // Hunger comes at the beginning of a tick and poison at its end, so poison eaten now was the last loss.
        const bool poisoned = living_.poisoned_tick[i] == tick;
        fate_.cause[id] = poisoned ? CauseOfDeath::Poisoned : CauseOfDeath::Starved;
        ++(poisoned ? counts_.poisoned_count : counts_.starved_count);
        fate_.lived_ticks[id] = tick;
    }
    bodies_.keep_only(keep_);
    living_.keep_only(keep_);
}

void Island::update_hash(base::Executor& executor) {
    const std::size_t n = living_.size();
    hash_of_block_.assign((n + organisms_per_block - 1) / organisms_per_block, {});
    executor.parallel_for(n, organisms_per_block, [&](base::Range range) {
        base::StateHash sum;
        for (std::size_t i = range.begin; i < range.end; ++i)
            sum += base::EntityHash{OrganismKind, bodies_.id[i]}
                       .add(bodies_.x[i], bodies_.y[i])
                       .add(bodies_.velocity_x[i], bodies_.velocity_y[i])
                       .add(std::uint64_t{std::bit_cast<std::uint32_t>(living_.health[i])})
                       .finish();
        hash_of_block_[range.begin / organisms_per_block] = sum;
    });
    hash_ = born_hash_ + food_.hash() + poison_.hash();
    for (const base::StateHash& sum : hash_of_block_)
        hash_ += sum;
    for (std::uint32_t i = 0; i < crate_count_; ++i)
        hash_ += base::EntityHash{CrateKind, i}
                     .add(boxes_.x[i], boxes_.y[i])
                     .add(boxes_.velocity_x[i], boxes_.velocity_y[i])
                     .finish();
}

std::vector<double> Island::fitness(const Parameters& parameters, std::uint32_t tick, base::Executor& executor) const {
    const auto organisms = static_cast<std::size_t>(born_.genes.cols());
    std::vector<double> fitness(organisms);
    if (parameters.fitness == FitnessFunction::Life) {
        for (std::size_t id = 0; id < organisms; ++id)
            fitness[id] = fate_.lived_ticks[id] * parameters.tick_s;
        for (std::size_t i = 0; i < living_.size(); ++i)
            fitness[bodies_.id[i]] = tick * parameters.tick_s + static_cast<double>(living_.health[i]);
        return fitness;
    }
    const auto function = parameters.fitness == FitnessFunction::GeneSum ? gene_sum : rastrigin;
    executor.parallel_for(organisms, organisms_per_block, [&](base::Range range) {
        for (std::size_t id = range.begin; id < range.end; ++id)
            fitness[id] = function(born_.genes.col(static_cast<Eigen::Index>(id)));
    });
    return fitness;
}

std::optional<std::size_t> Island::body_of(std::uint32_t id) const {
    const auto found = std::lower_bound(bodies_.id.begin(), bodies_.id.end(), id);
    if (found == bodies_.id.end() || *found != id)
        return std::nullopt;
    return static_cast<std::size_t>(found - bodies_.id.begin());
}

LiveStatistics Island::live_statistics() const {
    double health = 0;
    for (const float value : living_.health)
        health += static_cast<double>(value);
    const std::size_t alive = living_.size();
    return {.organism_count = static_cast<std::uint32_t>(born_.genes.cols()),
            .alive_count = static_cast<std::uint32_t>(alive),
            .health_mean = alive == 0 ? 0 : health / static_cast<double>(alive),
            .food_eaten = counts_.food_eaten,
            .poison_eaten = counts_.poison_eaten,
            .starved_count = counts_.starved_count,
            .poisoned_count = counts_.poisoned_count};
}

} // namespace evod::simulation
