#include "server/simulation/island.h"

#include "server/base/assert.h"
#include "server/base/elementary.h"
#include "server/simulation/fitness.h"
#include "server/simulation/placement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace evod::simulation {
namespace {

// The kinds of entities in the state hash, except organisms and what they have eaten (6, meals.cpp). The hashes of
// every run depend on these numbers.
enum HashKind : std::uint32_t {
    FoodKind = 2,
    PoisonKind = 3,
    CrateKind = 4,
    ChromosomeKind = 5,
    PlacedKind = 7,
    ColonyKind = 9, // number, species, age and parents of an organism of a colony
    HandlingKind = 10,
};

bool is_kinematic(const parameters::Parameters& p) {
    return p.controller == evolution::Controller::Network && p.locomotion == evolution::Locomotion::Kinematic;
}

physics::StepParameters step_parameters(const parameters::Parameters& p) {
    constexpr physics::Integrator integrators[] = {
        physics::Integrator::SymplecticEuler, physics::Integrator::ExplicitEuler, physics::Integrator::BackwardEuler};
    // Kinematic bodies move with their new velocities.
    const std::size_t integrator = is_kinematic(p) ? 0 : static_cast<std::size_t>(p.integrator);
    return {.integration = physics::integration(integrators[integrator], p.tick_s, physics::damping_rate(p.damping)),
            .restitution = static_cast<float>(p.restitution),
            .max_speed_px_s = static_cast<float>(p.max_speed_px_s)};
}

/// The age at which organisms of a species die, at least 1 tick; 0: no age is lethal.
std::uint32_t lifespan_ticks(const parameters::Parameters& p) {
    const bool is_lethal = parameters::has_births(p) && p.lifespan_s > 0;
    return is_lethal ? static_cast<std::uint32_t>(std::max(std::ceil(p.lifespan_s / p.tick_s - 1e-6), 1.0)) : 0;
}

BehaviourRules behaviour_rules(const parameters::Parameters& p) {
    return {.flee_rule = p.flee_rule,
            .lookahead_s = static_cast<float>(p.steering_lookahead_s),
            .certain_impulse = static_cast<float>(p.flee_certain_impulse),
            .force_per_unit = static_cast<float>(p.force_per_unit)};
}

} // namespace

ItemRules Island::item_rules(const parameters::Parameters& p) {
    // The quotient is slightly reduced before it is rounded up, so that 23/60 s are exactly 23 ticks of 1/60 s.
    const double ticks = std::ceil(p.respawn_s / p.tick_s - 1e-6);
    return {.placement = base::Purpose::FoodPlacement,
            .respawn_purpose = base::Purpose::FoodRespawn,
            .kind = FoodKind,
            .count = 0,
            .radius_px = static_cast<float>(p.item_radius_px),
            .margin_px = static_cast<float>(p.spawn_margin_px),
            .respawn = p.respawn,
            .respawn_ticks = static_cast<std::uint32_t>(std::clamp(ticks, 1.0, 1e9))};
}

void Island::begin_generation(const parameters::Parameters& parameters, std::uint64_t generation,
                              evolution::NextGeneration bred, base::Executor& executor,
                              std::optional<IslandOpening> opening) {
    EVOD_ASSERT(generation >= 1);
    EVOD_ASSERT(bred.genes.rows() == evolution::gene_count(parameters));
    EVOD_ASSERT(bred.parents.empty() || bred.parents.size() == static_cast<std::size_t>(bred.genes.cols()));
    born_ = {}; // frees the previous chromosomes now: Eigen's move assignment would exchange them with the new ones
    born_ = std::move(bred);
    arrivals_.clear();
    opening_ = opening ? std::make_shared<const IslandOpening>(*std::move(opening)) : nullptr;
    has_births_ = parameters::has_births(parameters);
    generation_ = generation;
    behaviour_key_ = base::RandomKey{seed_, base::Purpose::Behaviour, index_, generation};
    const auto organisms = static_cast<std::size_t>(born_.genes.cols());
    life_records_.begin_generation(organisms, simulation::is_colony(parameters));
    counts_ = {};
    colony_ = {};
    latest_born_ = {};
    hunt_ = {};
    food_counts_ = parameters.fitness_per_food != 0;
    poison_counts_ = parameters.fitness_per_poison != 0;
    eaten_hash_ = {};
    brain_ = evolution::brain_layout(parameters);
    is_kinematic_ = is_kinematic(parameters);
    heading_key_ = base::RandomKey{seed_, base::Purpose::Heading, index_, generation};
    living_.clear(brain_.weight_count(), simulation::is_colony(parameters));
    bodies_.clear();
    boxes_.clear();
    alive_count_ = 0;
    body_of_.clear();
    stepper_.near().invalidate();
    renewals_ = 0;

    std::vector<base::StateHash> hash_of_block((organisms + organisms_per_block - 1) / organisms_per_block);
    executor.parallel_for(organisms, organisms_per_block, [&](base::Range range) {
        for (std::size_t id = range.begin; id < range.end; ++id) {
            hash_of_block[range.begin / organisms_per_block] += hash_of_birth(static_cast<std::uint32_t>(id));
        }
    });
    born_hash_ = {};
    for (const base::StateHash& hash : hash_of_block) {
        born_hash_ += hash;
    }
    hash_ = born_hash_;
    if (parameters::has_bodies(parameters)) {
        fill(parameters, generation, executor);
    }
}

base::StateHash Island::hash_of_birth(std::uint32_t id) const {
    const evolution::ConstGenes genes = evolution::column(born_.genes, id);
    base::EntityHash entity{ChromosomeKind, id};
    for (std::size_t gene = 0; gene < genes.size(); gene += 2) {
        entity.add(genes[gene], gene + 1 < genes.size() ? genes[gene + 1] : 0.0f);
    }
    base::StateHash hash = entity.finish();
    if (id >= bred_count()) {
        hash += base::EntityHash{PlacedKind, id}.add(std::uint64_t{placed_tick(id)}).finish();
    }
    if (is_colony()) {
        const evolution::Parents parents = parents_of_child(id);
        base::EntityHash colony{ColonyKind, id};
        colony.add(std::uint64_t{species_of(id) == Species::Predator});
        if (has_births_) {
            const bool is_old = opening_ != nullptr && id < bred_count();
            colony.add(std::uint64_t{parents.first} << 32 | parents.second)
                .add(std::uint64_t{number_of(id)} << 32 | (is_old ? opening_->age_ticks[id] : 0));
        }
        hash += colony.finish();
    }
    return hash;
}

std::uint32_t Island::number_of(std::uint32_t id) const {
    if (opening_ == nullptr) {
        return id;
    }
    return id < bred_count() ? opening_->numbers[id] : opening_->next_number + (id - bred_count());
}

std::uint32_t Island::age_ticks(std::uint32_t id, std::uint32_t tick) const {
    const std::uint32_t before = opening_ != nullptr && id < bred_count() ? opening_->age_ticks[id] : 0;
    return before +
           (life_records_.cause[id] == CauseOfDeath::Alive ? tick - placed_tick(id) : life_records_.lived_ticks[id]);
}

void Island::fill(const parameters::Parameters& parameters, std::uint64_t generation, base::Executor& executor) {
    const parameters::IslandPlan plan = parameters::island_plan(parameters);
    area_ = {physics::to_units(plan.width_px), physics::to_units(plan.height_px)};
    step_parameters_ = step_parameters(parameters);

    PlacedBoxes placed = place_boxes({.obstacle_count = parameters.obstacle_count,
                                      .crate_count = parameters.crate_count,
                                      .obstacle_half_size_px = static_cast<float>(parameters.obstacle_size_px / 2),
                                      .crate_half_size_px = static_cast<float>(parameters.crate_size_px / 2),
                                      .crate_mass_kg = static_cast<float>(parameters.crate_mass_kg),
                                      .margin_px = static_cast<float>(parameters.spawn_margin_px)},
                                     seed_, index_, generation, area_);
    obstacles_ = BoxGrid{area_, placed.obstacles};
    boxes_ = std::move(placed.crates);
    crate_count_ = static_cast<std::uint32_t>(boxes_.size());
    const physics::Boxes& obstacles = placed.obstacles;
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
        boxes_.add(obstacles.x[i], obstacles.y[i], obstacles.half_width[i], obstacles.half_height[i], 0);
    }

    const auto organisms = static_cast<std::size_t>(born_.genes.cols());
    std::vector<float> radius(organisms);
    const auto shape_of = [&](std::size_t id) {
        return body_shape(born_.genes(evolution::BodySize, static_cast<Eigen::Index>(id)), parameters);
    };
    for (std::size_t id = 0; id < organisms; ++id) {
        radius[id] = shape_of(id).radius_px;
    }
    std::vector<Place> places;
    if (opening_ == nullptr) {
        places = place_circles(radius, seed_, index_, generation, area_, BoxGrid{area_, boxes_}, executor,
                               static_cast<float>(parameters.spawn_margin_px));
    } else {
        for (const IslandState::Organism& organism : opening_->state.organisms) {
            places.push_back({organism.x, organism.y});
        }
    }
    bodies_.resize(organisms);
    living_.resize(organisms);
    const parameters::Parameters of_predators = parameters::of_predators(parameters);
    lifespan_ticks_ = {lifespan_ticks(parameters), lifespan_ticks(of_predators)};
    executor.parallel_for(organisms, organisms_per_block, [&](base::Range range) {
        for (std::size_t id = range.begin; id < range.end; ++id) {
            bodies_.put(id, {.id = static_cast<std::uint32_t>(id),
                             .x = places[id].x,
                             .y = places[id].y,
                             .radius = radius[id],
                             .mass = shape_of(id).mass_kg});
            const bool is_predator = id >= organisms - born_.predator_count;
            put_living(id, static_cast<std::uint32_t>(id), is_predator ? of_predators : parameters);
        }
    });
    alive_count_ = static_cast<std::uint32_t>(organisms);
    body_of_.resize(organisms);
    std::iota(body_of_.begin(), body_of_.end(), 0u);

    ItemRules rules = item_rules(parameters);
    rules.count = opening_ == nullptr ? plan.food_count : static_cast<std::uint32_t>(opening_->state.food.size());
    food_.begin_generation(rules, seed_, index_, generation, area_, obstacles_, executor);
    rules.count = opening_ == nullptr ? plan.poison_count : static_cast<std::uint32_t>(opening_->state.poison.size());
    rules.placement = base::Purpose::PoisonPlacement;
    rules.respawn_purpose = base::Purpose::PoisonRespawn;
    rules.kind = PoisonKind;
    poison_.begin_generation(rules, seed_, index_, generation, area_, obstacles_, executor);
    perception_.begin(bodies_, living_, food_, poison_);
    if (is_colony()) {
        begin_colony(parameters, executor);
    }
}

void Island::put_living(std::size_t body, std::uint32_t id, const parameters::Parameters& parameters) {
    living_.put(body, evolution::body_genes(born_.genes, id), parameters);
    if (living_.in_colony()) {
        const std::uint32_t lifespan = lifespan_ticks_[static_cast<std::size_t>(species_of(id))];
        const std::uint32_t age = opening_ != nullptr && id < bred_count() ? opening_->age_ticks[id] : 0;
        living_.hunts_from[body] = 0;
        living_.dies_in[body] =
            lifespan == 0 ? LivingOrganisms::never_old : placed_tick(id) + (lifespan > age ? lifespan - age : 1);
    }
    if (living_.has_brains()) {
        base::RandomStream random{heading_key_, id};
        const auto heading = static_cast<float>(random.uniform(-base::pi, base::pi));
        living_.put_brain(body, weights_of(id), heading);
        if (is_kinematic_) {
            const auto speed = static_cast<float>(random.uniform()) * step_parameters_.max_speed_px_s;
            const base::Direction ahead = base::direction_of(heading);
            bodies_.velocity_x[body] = speed * ahead.x;
            bodies_.velocity_y[body] = speed * ahead.y;
        }
    }
}

std::span<const float> Island::weights_of(std::uint32_t id) const {
    return evolution::column(born_.genes, id).subspan(evolution::body_gene_count, living_.weight_count());
}

void Island::skip_tick(std::uint32_t tick) {
    if (tick == 1) {
        hash_ = whole_hash(); // before the first tick, it covers only the chromosomes and what commands have changed
    }
}

/// The work of a tick, in the order of this function:
/// 1. The list of near pairs is rebuilt if bodies have moved too far. Due items reappear. Where an item has appeared or
///    disappeared, the cached perceptions of organisms near it become invalid.
/// 2. First loop: organisms without a valid perception perceive. All organisms lose health and choose their forces.
///    The forces change their velocities. Contacts are found.
/// 3. Contacts are resolved.
/// 4. Second loop: organisms move. Items that organisms touch, and organisms without health, are found. The block is
///    hashed.
/// 5. Organisms eat and die.
void Island::advance_tick(const parameters::Parameters& parameters, std::uint32_t tick, base::Executor& executor) {
    if (stepper_.near().stale(bodies_, boxes_)) {
        renew_near_pairs(executor);
    }
    for_each_kind(
        executor,
        [&] {
            food_.reappear(tick, obstacles_, executor);
            perception_.notice_food(bodies_, stepper_.near(), living_, food_, executor);
        },
        [&] {
            poison_.reappear(tick, obstacles_, executor);
            perception_.notice_poison(bodies_, stepper_.near(), living_, poison_, executor);
        });

    if (has_predators() && !hunt_.is_located()) {
        locate();
    }
    const BehaviourRules rules = behaviour_rules(parameters);
    const SteeringRules steering = steering_rules(brain_, parameters, area_);
    const std::size_t block_count = physics::block_count(bodies_.size());
    const std::size_t grain = physics::blocks_per_piece(bodies_.size());
    stepper_.begin(bodies_, boxes_, area_, step_parameters_);
    executor.parallel_for(block_count, grain, [&](base::Range blocks) {
        for (std::size_t block = blocks.begin; block < blocks.end; ++block) {
            if (living_.has_brains()) {
                act(steering, tick, block);
            } else {
                act(rules, tick, block);
            }
        }
    });
    if (!is_kinematic_) {
        stepper_.collide(bodies_, boxes_, executor);
    }

    food_claims_.begin(block_count);
    poison_claims_.begin(block_count);
    resize_blocks(block_count);
    executor.parallel_for(block_count, grain, [&](base::Range blocks) {
        for (std::size_t block = blocks.begin; block < blocks.end; ++block) {
            move(block);
        }
    });
    const physics::StepCounts step = stepper_.finish(boxes_);
    counts_.too_fast_count += step.too_fast;
    counts_.speed_limit_count += step.speed_limited;
    base::StateHash organisms = feed_and_remove_dead(parameters, tick, executor);
    if (has_predators()) {
        organisms += eat_prey(parameters, tick, executor);
    }
    hash_ = born_hash_ + food_.hash() + poison_.hash() + organisms + eaten_hash_ + hash_of_boxes();
    if (is_colony()) {
        hash_ += hash_of_handling();
        if (births_are_due(parameters, tick)) {
            give_birth(parameters, tick);
        }
        count_living();
    }
}

void Island::resize_blocks(std::size_t count) {
    constexpr std::size_t usually_enough = 32;
    const std::size_t before = blocks_.size();
    blocks_.resize(count);
    for (std::size_t block = before; block < count; ++block) {
        blocks_[block].dying.reserve(usually_enough);
    }
}

void Island::renew_near_pairs(base::Executor& executor) {
    // Without sorting, a tick of 1,000,000 organisms takes 30 % longer, and a tick of 20,000 takes the same time.
    // Sorting more often than at every fourth renewal costs more than it saves.
    constexpr std::uint32_t renewals_between = 4;
    constexpr std::size_t worth_ordering = 1024;
    physics::NearPairs& near = stepper_.near();
    near.sort(bodies_, boxes_, area_, executor);
    const bool many_are_void = alive_count_ < bodies_.size() - bodies_.size() / 8;
    if ((renewals_++ % renewals_between == 0 && bodies_.size() > worth_ordering) || many_are_void) {
        reorder(executor);
    }
    if (is_kinematic_) {
        near.list_none(bodies_);
    } else {
        near.list(bodies_, boxes_, executor);
    }
}

void Island::reorder(base::Executor& executor) {
    physics::NearPairs& near = stepper_.near();
    const physics::Reordering reordering{near.strips().order(), spare_column_, executor};
    bodies_.reorder(reordering);
    living_.reorder(reordering);
    perception_.reorder(reordering);
    hunt_.forget();
    near.follow_reordering(bodies_, executor);
    executor.parallel_for(bodies_.size(), 2 * organisms_per_block, [&](base::Range range) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            body_of_[bodies_.id[i]] = static_cast<std::uint32_t>(i);
            if (living_.has_brains()) {
                living_.put_weights(i, weights_of(bodies_.id[i]));
            }
        }
    });
}

void Island::act(const BehaviourRules& rules, std::uint32_t tick, std::size_t block) {
    const base::Range range = physics::circles_of_block(bodies_.size(), block);
    perception_.search(bodies_, living_, food_, poison_, range);
    ChosenForces forces;
    live_and_choose(seen_columns(range, tick), rules, behaviour_key_, tick, range, forces);
    stepper_.accelerate(bodies_, block, {forces.x.data(), forces.y.data()});
}

OrganismColumns Island::seen_columns(base::Range block, std::uint32_t tick) {
    OrganismColumns seen = columns();
    if (has_predators()) {
        hunt_.look(bodies_, living_, block, tick, seen);
    }
    return seen;
}

void Island::act(const SteeringRules& rules, std::uint32_t tick, std::size_t block) {
    const base::Range range = physics::circles_of_block(bodies_.size(), block);
    perception_.search(bodies_, living_, food_, poison_, range);
    ChosenForces outcome;
    live_and_steer(seen_columns(range, tick), living_, rules, range, outcome);
    if (is_kinematic_) {
        const std::size_t count = range.end - range.begin;
        std::copy_n(outcome.x.begin(), count, bodies_.velocity_x.begin() + static_cast<std::ptrdiff_t>(range.begin));
        std::copy_n(outcome.y.begin(), count, bodies_.velocity_y.begin() + static_cast<std::ptrdiff_t>(range.begin));
    } else {
        stepper_.accelerate(bodies_, block, {outcome.x.data(), outcome.y.data()});
    }
}

void Island::move(std::size_t block) {
    const base::Range range = physics::circles_of_block(bodies_.size(), block);
    stepper_.move(bodies_, block);
    std::uint32_t food_indices[physics::circles_per_block], poison_indices[physics::circles_per_block];
    FoundIndices at_food{food_indices}, at_poison{poison_indices};
    const OrganismColumns organisms = columns();
    organism_kernels().follow(organisms, range.begin, range.end, at_food, at_poison);
    if (has_predators()) {
        leave_out_predators(at_food);
        leave_out_predators(at_poison);
    }
    food_claims_.find_touches(block, {at_food.indices, at_food.count}, bodies_, food_);
    poison_claims_.find_touches(block, {at_poison.indices, at_poison.count}, bodies_, poison_);

    std::uint32_t dying_indices[physics::circles_per_block];
    FoundIndices dying{dying_indices};
    const HashWords hash = organism_kernels().hash(organisms, organism_hash_kind, range.begin, range.end, dying);
    blocks_[block].hash = {hash.low, hash.high};
    if (living_.has_brains()) {
        const HashWords headings =
            brain_kernels().hash(organisms, living_.heading.data(), heading_hash_kind, range.begin, range.end);
        blocks_[block].hash += base::StateHash{headings.low, headings.high};
    }
    blocks_[block].dying.assign(dying_indices, dying_indices + dying.count);
}

void Island::leave_out_predators(FoundIndices& found) const {
    const auto end = std::remove_if(found.indices, found.indices + found.count,
                                    [&](std::uint32_t body) { return hunt_.is_predator(body); });
    found.count = static_cast<std::size_t>(end - found.indices);
}

base::StateHash Island::hash_of_handling() const {
    base::StateHash hash;
    for (std::size_t body = 0; has_predators() && body < bodies_.size(); ++body) {
        if (living_.hunts_from[body] != 0 && !bodies_.is_void(body)) {
            hash +=
                base::EntityHash{HandlingKind, bodies_.id[body]}.add(std::uint64_t{living_.hunts_from[body]}).finish();
        }
    }
    return hash;
}

base::StateHash Island::hash_of_boxes() const {
    base::StateHash hash;
    for (std::uint32_t i = 0; i < crate_count_; ++i) {
        hash += base::EntityHash{CrateKind, i}
                    .add(boxes_.x[i], boxes_.y[i])
                    .add(boxes_.velocity_x[i], boxes_.velocity_y[i])
                    .finish();
    }
    return hash;
}

base::StateHash Island::whole_hash() const {
    base::StateHash hash =
        born_hash_ + food_.hash() + poison_.hash() + eaten_hash_ + hash_of_boxes() + hash_of_handling();
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
        if (!bodies_.is_void(body)) {
            hash += hash_of_organism(bodies_, living_, body);
        }
    }
    return hash;
}

Island::Life Island::life(std::uint32_t id, std::uint32_t tick) const {
    const bool dead = body_of_[id] == no_body;
    return {.lived_ticks = dead ? life_records_.lived_ticks[id] : tick - placed_tick(id),
            .health = dead ? 0 : living_.health[body_of_[id]],
            .food_eaten = life_records_.food_eaten[id],
            .poison_eaten = life_records_.poison_eaten[id]};
}

std::vector<double> Island::fitness(const parameters::Parameters& parameters, std::uint32_t tick,
                                    base::Executor& executor) const {
    const auto organisms = static_cast<std::size_t>(born_.genes.cols());
    std::vector<double> fitness(organisms);
    if (has_births_) {
        std::ranges::copy(life_records_.children, fitness.begin());
        return fitness;
    }
    if (parameters.fitness == parameters::FitnessFunction::Life) {
        executor.parallel_for(organisms, organisms_per_block, [&](base::Range range) {
            for (std::size_t id = range.begin; id < range.end; ++id) {
                const Life organism = life(static_cast<std::uint32_t>(id), tick);
                const double lived_s = organism.lived_ticks * parameters.tick_s;
                fitness[id] = parameters.fitness_per_second * lived_s +
                              parameters.fitness_per_health * static_cast<double>(organism.health) +
                              parameters.fitness_per_food * organism.food_eaten +
                              parameters.fitness_per_poison * organism.poison_eaten;
            }
        });
        return fitness;
    }
    const auto function = parameters.fitness == parameters::FitnessFunction::GeneSum ? gene_sum : rastrigin;
    executor.parallel_for(organisms, organisms_per_block, [&](base::Range range) {
        for (std::size_t id = range.begin; id < range.end; ++id) {
            fitness[id] = function(evolution::body_genes(born_.genes, static_cast<std::uint32_t>(id)));
        }
    });
    return fitness;
}

std::vector<Intention> Island::intentions(const parameters::Parameters& parameters, std::uint32_t tick,
                                          base::Range ids) const {
    std::vector<std::uint32_t> asked_bodies;
    for (std::size_t id = ids.begin; id < ids.end; ++id) {
        if (const auto body = body_of(static_cast<std::uint32_t>(id))) {
            asked_bodies.push_back(static_cast<std::uint32_t>(*body));
        }
    }
    std::vector<Intention> of_living(asked_bodies.size());
    const std::optional<Hunt> hunt = present_hunt();
    const Hunt* const hunted = hunt ? &*hunt : nullptr;
    if (living_.has_brains()) {
        predict_steering(bodies_, living_, food_, poison_, hunted, steering_rules(brain_, parameters, area_),
                         parameters.tick_s, tick, asked_bodies, of_living);
    } else {
        predict_intentions(bodies_, living_, food_, poison_, hunted, behaviour_rules(parameters), behaviour_key_, tick,
                           asked_bodies, of_living);
    }
    std::vector<Intention> intentions(ids.end - ids.begin);
    for (std::size_t k = 0; k < asked_bodies.size(); ++k) {
        intentions[bodies_.id[asked_bodies[k]] - ids.begin] = of_living[k];
    }
    return intentions;
}

std::optional<Hunt> Island::present_hunt() const {
    if (!has_predators()) {
        return std::nullopt;
    }
    Hunt hunt;
    hunt.locate(bodies_, area_, [&](std::uint32_t id) { return species_of(id) == Species::Predator; });
    return hunt;
}

std::optional<Activations> Island::activations(const parameters::Parameters& parameters, std::uint32_t tick,
                                               std::uint32_t id) const {
    const auto body = body_of(id);
    if (!body || !living_.has_brains()) {
        return std::nullopt;
    }
    const std::optional<Hunt> hunt = present_hunt();
    return predict_activations(bodies_, living_, food_, poison_, hunt ? &*hunt : nullptr,
                               steering_rules(brain_, parameters, area_), tick, static_cast<std::uint32_t>(*body));
}

physics::MotionReport Island::motion_report(const parameters::Parameters& parameters) const {
    if (!has_bodies()) {
        return {};
    }
    return physics::report_motion(bodies_, boxes_, area_, parameters.tick_s, stepper_.near());
}

std::optional<std::size_t> Island::body_of(std::uint32_t id) const {
    if (id >= body_of_.size() || body_of_[id] == no_body) {
        return std::nullopt;
    }
    return body_of_[id];
}

LiveStatistics Island::live_counts() const {
    return {.organism_count = static_cast<std::uint32_t>(born_.genes.cols()),
            .alive_count = alive_count_,
            .food_eaten = counts_.food_eaten,
            .poison_eaten = counts_.poison_eaten,
            .starved_count = counts_.starved_count,
            .poisoned_count = counts_.poisoned_count,
            .eaten_count = colony_[0].eaten,
            .old_count = colony_[0].old + colony_[1].old,
            .born_count = colony_[0].born + colony_[1].born,
            .predator_count = colony_[1].living};
}

LiveStatistics Island::live_statistics() const {
    LiveStatistics live = live_counts();
    live.health_mean = mean_health(std::span{living_.health}.first(bodies_.size()), alive_count_);
    return live;
}

} // namespace evod::simulation
