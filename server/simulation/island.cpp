#include "server/simulation/island.h"

#include "server/base/assert.h"
#include "server/simulation/fitness.h"
#include "server/simulation/placement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace evod::simulation {
namespace {

// The kinds of entities in the state hash, except organisms. The hashes of every run depend on these numbers.
enum HashKind : std::uint32_t { FoodKind = 2, PoisonKind = 3, CrateKind = 4, ChromosomeKind = 5, PlacedKind = 6 };

constexpr std::size_t organisms_per_block = 1024;
/// Meals cannot raise health above this value: a meal gives at most 10,000, which is lost to rounding if it is added to
/// so large a float.
constexpr float health_reachable = 0x1p38f;
/// No parameter allows a gene above this value.
constexpr float gene_reachable = 10'000;

physics::StepParameters step_parameters(const parameters::Parameters& p) {
    constexpr physics::Integrator integrators[] = {
        physics::Integrator::SymplecticEuler, physics::Integrator::ExplicitEuler, physics::Integrator::BackwardEuler};
    return {.integration = physics::integration(integrators[static_cast<std::size_t>(p.integrator)], p.tick_s,
                                                physics::damping_rate(p.damping)),
            .restitution = static_cast<float>(p.restitution),
            .max_speed_px_s = static_cast<float>(p.max_speed_px_s)};
}

ItemRules item_rules(const parameters::Parameters& p) {
    // The quotient is slightly reduced before it is rounded up, so that 23/60 s are exactly 23 ticks of 1/60 s.
    const double ticks = std::ceil(p.respawn_s / p.tick_s - 1e-6);
    return {.placement = base::Purpose::FoodPlacement,
            .respawn_purpose = base::Purpose::FoodRespawn,
            .kind = FoodKind,
            .count = 0,
            .radius_px = static_cast<float>(p.item_radius_px),
            .respawn = p.respawn,
            .respawn_ticks = static_cast<std::uint32_t>(std::clamp(ticks, 1.0, 1e9))};
}

BehaviourRules behaviour_rules(const parameters::Parameters& p) {
    return {.flee_rule = p.flee_rule,
            .lookahead_s = static_cast<float>(p.steering_lookahead_s),
            .certain_impulse = static_cast<float>(p.flee_certain_impulse),
            .force_per_unit = static_cast<float>(p.force_per_unit)};
}

} // namespace

void Island::begin_generation(const parameters::Parameters& parameters, std::uint64_t generation,
                              evolution::NextGeneration bred, base::Executor& executor) {
    EVOD_ASSERT(generation >= 1);
    EVOD_ASSERT(bred.genes.rows() == evolution::gene_count);
    EVOD_ASSERT(bred.parents.empty() || bred.parents.size() == static_cast<std::size_t>(bred.genes.cols()));
    born_ = std::move(bred);
    placed_.clear();
    behaviour_key_ = base::RandomKey{seed_, base::Purpose::Behaviour, index_, generation};
    const auto organisms = static_cast<std::size_t>(born_.genes.cols());
    fate_.begin_generation(organisms);
    counts_ = {};
    living_.clear();
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
    if (parameters.fitness == parameters::FitnessFunction::Life) {
        fill(parameters, generation, executor);
    }
}

base::StateHash Island::hash_of_birth(std::uint32_t id) const {
    const float* genes = born_.genes.data() + std::size_t{id} * evolution::gene_count;
    base::StateHash hash = base::EntityHash{ChromosomeKind, id}
                               .add(genes[0], genes[1])
                               .add(genes[2], genes[3])
                               .add(genes[4], genes[5])
                               .finish();
    if (id >= bred_count()) {
        hash += base::EntityHash{PlacedKind, id}.add(std::uint64_t{placed_tick(id)}).finish();
    }
    return hash;
}

void Island::fill(const parameters::Parameters& parameters, std::uint64_t generation, base::Executor& executor) {
    const parameters::IslandPlan plan = parameters::island_plan(parameters);
    area_ = {physics::to_units(plan.width_px), physics::to_units(plan.height_px)};
    step_parameters_ = step_parameters(parameters);

    PlacedBoxes placed = place_boxes({.obstacle_count = parameters.obstacle_count,
                                      .crate_count = parameters.crate_count,
                                      .obstacle_half_size_px = static_cast<float>(parameters.obstacle_size_px / 2),
                                      .crate_half_size_px = static_cast<float>(parameters.crate_size_px / 2),
                                      .crate_mass_kg = static_cast<float>(parameters.crate_mass_kg)},
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
    const std::vector<Place> places =
        place_circles(radius, seed_, index_, generation, area_, BoxGrid{area_, boxes_}, executor);
    bodies_.resize(organisms);
    living_.resize(organisms);
    executor.parallel_for(organisms, organisms_per_block, [&](base::Range range) {
        for (std::size_t id = range.begin; id < range.end; ++id) {
            bodies_.put(id, {.id = static_cast<std::uint32_t>(id),
                             .x = places[id].x,
                             .y = places[id].y,
                             .radius = radius[id],
                             .mass = shape_of(id).mass_kg});
            living_.put(id, born_.genes.col(static_cast<Eigen::Index>(id)), parameters);
        }
    });
    alive_count_ = static_cast<std::uint32_t>(organisms);
    body_of_.resize(organisms);
    std::iota(body_of_.begin(), body_of_.end(), 0u);

    ItemRules rules = item_rules(parameters);
    rules.count = plan.food_count;
    food_.begin_generation(rules, seed_, index_, generation, area_, obstacles_, executor);
    rules.count = plan.poison_count;
    rules.placement = base::Purpose::PoisonPlacement;
    rules.respawn_purpose = base::Purpose::PoisonRespawn;
    rules.kind = PoisonKind;
    poison_.begin_generation(rules, seed_, index_, generation, area_, obstacles_, executor);
    perception_.begin(bodies_, living_, food_, poison_);
}

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

    const BehaviourRules rules = behaviour_rules(parameters);
    const std::size_t block_count = physics::block_count(bodies_.size());
    const std::size_t grain = physics::blocks_per_piece(bodies_.size());
    stepper_.begin(bodies_, boxes_, area_, step_parameters_);
    executor.parallel_for(block_count, grain, [&](base::Range blocks) {
        for (std::size_t block = blocks.begin; block < blocks.end; ++block) {
            act(rules, tick, block);
        }
    });
    stepper_.collide(bodies_, boxes_, executor);

    food_feeding_.begin(block_count);
    poison_feeding_.begin(block_count);
    resize_blocks(block_count);
    executor.parallel_for(block_count, grain, [&](base::Range blocks) {
        for (std::size_t block = blocks.begin; block < blocks.end; ++block) {
            move(block);
        }
    });
    const physics::StepCounts step = stepper_.finish(boxes_);
    counts_.too_fast_count += step.too_fast;
    counts_.speed_limit_count += step.speed_limited;
    const base::StateHash organisms = feed_and_remove_dead(parameters, tick, executor);
    hash_ = born_hash_ + food_.hash() + poison_.hash() + organisms + hash_of_boxes();
}

/// Processes food and poison, in parallel if that is faster.
template <class OfFood, class OfPoison>
void Island::for_each_kind(base::Executor& executor, OfFood&& of_food, OfPoison&& of_poison) {
    executor.parallel_for(2, physics::worth_dividing(bodies_.size()) ? 1 : 2, [&](base::Range kinds) {
        if (kinds.begin == 0) {
            of_food();
        }
        if (kinds.end == 2) {
            of_poison();
        }
    });
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
    near.list(bodies_, boxes_, executor);
}

void Island::reorder(base::Executor& executor) {
    physics::NearPairs& near = stepper_.near();
    const physics::Reordering reordering{near.strips().order(), spare_column_, executor};
    bodies_.reorder(reordering);
    living_.reorder(reordering);
    perception_.reorder(reordering);
    near.follow_reordering(bodies_, executor);
    executor.parallel_for(bodies_.size(), 2 * organisms_per_block, [&](base::Range range) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            body_of_[bodies_.id[i]] = static_cast<std::uint32_t>(i);
        }
    });
}

void Island::act(const BehaviourRules& rules, std::uint32_t tick, std::size_t block) {
    const base::Range range = physics::circles_of_block(bodies_.size(), block);
    perception_.search(bodies_, living_, food_, poison_, range);
    ChosenForces forces;
    live_and_choose(columns(), rules, behaviour_key_, tick, range, forces);
    stepper_.accelerate(bodies_, block, {forces.x.data(), forces.y.data()});
}

void Island::move(std::size_t block) {
    const base::Range range = physics::circles_of_block(bodies_.size(), block);
    stepper_.move(bodies_, block);
    std::uint32_t food_indices[physics::circles_per_block], poison_indices[physics::circles_per_block];
    FoundIndices at_food{food_indices}, at_poison{poison_indices};
    const OrganismColumns organisms = columns();
    organism_kernels().follow(organisms, range.begin, range.end, at_food, at_poison);
    food_feeding_.find_touches(block, {at_food.indices, at_food.count}, bodies_, food_);
    poison_feeding_.find_touches(block, {at_poison.indices, at_poison.count}, bodies_, poison_);

    std::uint32_t dying_indices[physics::circles_per_block];
    FoundIndices dying{dying_indices};
    const HashWords hash = organism_kernels().hash(organisms, organism_hash_kind, range.begin, range.end, dying);
    blocks_[block].hash = {hash.low, hash.high};
    blocks_[block].dying.assign(dying_indices, dying_indices + dying.count);
}

base::StateHash Island::feed_and_remove_dead(const parameters::Parameters& parameters, std::uint32_t tick,
                                             base::Executor& executor) {
    // Organisms are processed in blocks, in parallel. The grids of items are then changed sequentially.
    constexpr std::size_t events_worth_dividing = 128;
    std::size_t events = food_feeding_.award() + poison_feeding_.award();
    for (const Block& block : blocks_) {
        events += block.dying.size();
    }
    executor.parallel_for(blocks_.size(), events < events_worth_dividing ? blocks_.size() : 8, [&](base::Range blocks) {
        for (std::size_t block = blocks.begin; block < blocks.end; ++block) {
            feed_and_remove_dead_in_block(parameters, tick, block);
        }
    });

    base::StateHash organisms;
    for (const Block& block : blocks_) {
        organisms += block.hash;
        food_.add_to_hash(block.food_hash_change);
        poison_.add_to_hash(block.poison_hash_change);
        counts_.food_eaten += block.food_eaten;
        counts_.poison_eaten += block.poison_eaten;
        counts_.starved_count += block.starved;
        counts_.poisoned_count += block.poisoned;
        alive_count_ -= block.starved + block.poisoned;
    }
    const auto take_out = [this](Items& items, const Feeding& feeding) {
        constexpr std::size_t blocks_ahead = 4;
        for (std::size_t block = 0; block < blocks_.size(); ++block) {
            if (block + blocks_ahead < blocks_.size()) {
                for (const Touch& touch : feeding.touches(block + blocks_ahead)) {
                    items.prefetch_place(touch.place);
                }
            }
            for (const Touch& touch : feeding.touches(block)) {
                if (touch.gets_it) {
                    items.take_out(touch.item, touch.place);
                }
            }
        }
    };
    for_each_kind(
        executor, [&] { take_out(food_, food_feeding_); }, [&] { take_out(poison_, poison_feeding_); });
    return organisms;
}

void Island::feed_and_remove_dead_in_block(const parameters::Parameters& parameters, std::uint32_t tick,
                                           std::size_t index) {
    Block& block = blocks_[index];
    block.food_hash_change = block.poison_hash_change = {};
    block.food_eaten = block.poison_eaten = block.starved = block.poisoned = 0;
    for (const Touch& touch : food_feeding_.touches(index)) {
        food_.prefetch_item(touch.item);
        __builtin_prefetch(&fate_.food_eaten[touch.id], 1);
        __builtin_prefetch(&bodies_.id[touch.body]);
        __builtin_prefetch(&bodies_.x[touch.body]);
        __builtin_prefetch(&bodies_.y[touch.body]);
        __builtin_prefetch(&bodies_.velocity_x[touch.body]);
        __builtin_prefetch(&bodies_.velocity_y[touch.body]);
        __builtin_prefetch(&living_.health[touch.body], 1);
    }
    // All food is eaten before all poison. Items of one kind are equal, so their order does not matter.
    for (const Touch& touch : food_feeding_.touches(index)) {
        if (!touch.gets_it) {
            continue;
        }
        const float cap = parameters.health_cap_per_size > 0
                              ? health_cap(born_.genes.col(static_cast<Eigen::Index>(touch.id)), parameters)
                              : std::numeric_limits<float>::infinity();
        change_health(block, touch.body,
                      [&](float health) { return std::min(health + static_cast<float>(parameters.food_health), cap); });
        block.food_hash_change += food_.set_due(touch.item, tick);
        ++fate_.food_eaten[touch.id];
        ++block.food_eaten;
    }
    for (const Touch& touch : poison_feeding_.touches(index)) {
        if (!touch.gets_it) {
            continue;
        }
        change_health(block, touch.body,
                      [&](float health) { return health - static_cast<float>(parameters.poison_harm); });
        block.poison_hash_change += poison_.set_due(touch.item, tick);
        ++fate_.poison_eaten[touch.id];
        ++block.poison_eaten;
    }
    // The cost of living is subtracted at the beginning of a tick, and poison at its end. If a dying organism ate
    // poison in this tick, poison was therefore the cause of death.
    for (const Touch& touch : poison_feeding_.touches(index)) {
        if (touch.gets_it && is_dying(touch.body)) {
            record_death(block, touch.body, tick, CauseOfDeath::Poisoned);
            ++block.poisoned;
        }
    }
    for (const std::uint32_t body : block.dying) {
        if (is_dying(body)) {
            record_death(block, body, tick, CauseOfDeath::Starved);
            ++block.starved;
        }
    }
}

template <class Change>
void Island::change_health(Block& block, std::uint32_t body, Change&& change) {
    block.hash -= hash_of_organism(bodies_, living_, body);
    living_.health[body] = change(living_.health[body]);
    block.hash += hash_of_organism(bodies_, living_, body);
}

bool Island::is_dying(std::uint32_t body) const {
    return !bodies_.is_void(body) && living_.health[body] <= 0;
}

void Island::record_death(Block& block, std::uint32_t body, std::uint32_t tick, CauseOfDeath cause) {
    const std::uint32_t id = bodies_.id[body];
    fate_.cause[id] = cause;
    fate_.lived_ticks[id] = tick - placed_tick(id);
    block.hash -= hash_of_organism(bodies_, living_, body);
    body_of_[id] = no_body;
    bodies_.remove(body);
    perception_.remove(body);
    stepper_.near().remove(body);
    living_.health[body] = -std::numeric_limits<float>::infinity();
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

IslandShape Island::shape() const {
    return {.organisms = bred_count(),
            .has_bodies = has_bodies(),
            .crates = has_bodies() ? crate_count_ : 0,
            .food = has_bodies() ? food_.first_count() : 0,
            .poison = has_bodies() ? poison_.first_count() : 0};
}

IslandState Island::state(base::Executor& executor) const {
    IslandState state;
    state.fate = fate_;
    state.counts = counts_;
    if (!has_bodies()) {
        return state;
    }
    for (std::uint32_t id = bred_count(); id < fate_.cause.size(); ++id) {
        state.placed.push_back({.genes = {}, .tick = placed_tick(id)});
        std::ranges::copy(evolution::column(born_.genes, id), state.placed.back().genes.begin());
    }
    state.placed_food = food_.size() - food_.first_count();
    state.placed_poison = poison_.size() - poison_.first_count();
    for (std::uint32_t i = 0; i < crate_count_; ++i) {
        state.crates.push_back({boxes_.x[i], boxes_.y[i], boxes_.velocity_x[i], boxes_.velocity_y[i]});
    }
    executor.parallel_for(3, 1, [&](base::Range parts) {
        for (std::size_t part = parts.begin; part < parts.end; ++part) {
            if (part == 0) {
                state.food = food_.all();
            } else if (part == 1) {
                state.poison = poison_.all();
            } else {
                state.organisms.resize(body_of_.size());
            }
        }
    });
    executor.parallel_for(bodies_.size(), organisms_per_block, [&](base::Range range) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            if (!bodies_.is_void(i)) {
                state.organisms[bodies_.id[i]] = {bodies_.x[i], bodies_.y[i], bodies_.velocity_x[i],
                                                  bodies_.velocity_y[i], living_.health[i]};
            }
        }
    });
    return state;
}

base::Result<void> Island::check(const IslandState& state, std::uint32_t tick) const {
    const auto wrong = [this](const std::string& what) {
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = "island " + std::to_string(index_) + ": impossible state: " + what,
                             .violations = {}};
    };
    const Fate& fate = state.fate;
    const IslandShape own = shape();
    const std::size_t organisms = own.organisms + state.placed.size();
    if (fate.cause.size() != organisms || fate.lived_ticks.size() != organisms || fate.food_eaten.size() != organisms ||
        fate.poison_eaten.size() != organisms || state.organisms.size() != (own.has_bodies ? organisms : 0) ||
        state.placed.size() > placed_max || (!own.has_bodies && !state.placed.empty())) {
        return wrong("number of organisms");
    }
    for (const IslandState::Placed& placed : state.placed) {
        const auto is_gene = [](float gene) { return gene >= 0 && gene <= gene_reachable; };
        if (placed.tick > tick || !std::ranges::all_of(placed.genes, is_gene) ||
            placed.genes[evolution::BodySize] <= 0) {
            return wrong("a placed organism");
        }
    }
    if (state.crates.size() != own.crates) {
        return wrong("number of crates");
    }

    // Every tick limits the speeds at its end, so a greater speed can only be a rounding error.
    const float speed_max = step_parameters_.max_speed_px_s * 1.001f;
    const auto can_move = [&](const auto& body) {
        return body.x >= 0 && body.x <= area_.width && body.y >= 0 && body.y <= area_.height &&
               body.velocity_x * body.velocity_x + body.velocity_y * body.velocity_y <= speed_max * speed_max;
    };
    std::uint32_t alive = 0, starved = 0, poisoned = 0;
    for (std::size_t id = 0; id < organisms; ++id) {
        const auto which = [&](const char* what) { return wrong(what + (" of organism " + std::to_string(id))); };
        if (fate.cause[id] == CauseOfDeath::Alive) {
            if (fate.lived_ticks[id] != 0) {
                return which("lived_ticks");
            }
            if (!own.has_bodies) {
                continue;
            }
            ++alive;
            const IslandState::Organism& organism = state.organisms[id];
            if (!can_move(organism)) {
                return which("position or speed");
            }
            const bool has_lived = tick > (id < own.organisms ? 0 : state.placed[id - own.organisms].tick);
            if (!(std::abs(organism.health) <= health_reachable) || (organism.health <= 0 && has_lived)) {
                return which("health");
            }
            continue;
        }
        starved += fate.cause[id] == CauseOfDeath::Starved;
        poisoned += fate.cause[id] == CauseOfDeath::Poisoned;
        const bool removed = fate.cause[id] == CauseOfDeath::Removed;
        if (!own.has_bodies || fate.cause[id] > CauseOfDeath::Removed || (fate.lived_ticks[id] == 0 && !removed) ||
            fate.lived_ticks[id] > tick || state.organisms[id] != IslandState::Organism{}) {
            return which("death");
        }
    }
    if (starved != state.counts.starved_count || poisoned != state.counts.poisoned_count) {
        return wrong("number of dead organisms");
    }
    if (!std::ranges::all_of(state.crates, can_move)) {
        return wrong("position or speed of a crate");
    }
    if (state.food.size() != std::size_t{own.food} + state.placed_food ||
        state.poison.size() != std::size_t{own.poison} + state.placed_poison) {
        return wrong("number of food or poison items");
    }
    if (!own.has_bodies) {
        return state.food.empty() && state.poison.empty() ? base::Result<void>{} : wrong("items without bodies");
    }
    // On an island without living organisms, due items wait until an organism is placed and the next tick begins.
    const bool resting = alive == 0 || !state.placed.empty();
    if (const char* fault = food_.fault_of(state.food, tick, resting)) {
        return wrong(std::string{"food: "} + fault);
    }
    if (const char* fault = poison_.fault_of(state.poison, tick, resting)) {
        return wrong(std::string{"poison: "} + fault);
    }
    return {};
}

bool differ_only_by_commands(const IslandState& begun, const IslandState& state) {
    const auto is_kept = [](const Items::Item& before, Items::Item now) {
        now.due_tick = now.due_tick == Items::none ? before.due_tick : now.due_tick;
        return now == before;
    };
    const auto are_kept = [&](const base::Column<Items::Item>& before, const base::Column<Items::Item>& now) {
        return std::ranges::equal(before, std::span{now}.first(before.size()), is_kept);
    };
    for (std::size_t id = 0; id < begun.organisms.size(); ++id) {
        if (state.fate.cause[id] != CauseOfDeath::Removed && state.organisms[id] != begun.organisms[id]) {
            return false;
        }
    }
    const auto has_eaten = [](std::uint32_t count) { return count > 0; };
    return state.counts == begun.counts && state.crates == begun.crates && are_kept(begun.food, state.food) &&
           are_kept(begun.poison, state.poison) && std::ranges::none_of(state.fate.food_eaten, has_eaten) &&
           std::ranges::none_of(state.fate.poison_eaten, has_eaten);
}

void Island::restore(const IslandState& state, std::uint32_t tick, const parameters::Parameters& parameters,
                     base::Executor& executor) {
    counts_ = state.counts;
    if (!has_bodies()) {
        fate_ = state.fate;
        return;
    }
    // Before the first tick, hash_ covers only the chromosomes and what commands have changed.
    base::StateHash uncovered = whole_hash();
    uncovered -= hash_;
    std::vector<NewOrganism> placed; // with the positions that the loop over all organisms sets
    for (const IslandState::Placed& organism : state.placed) {
        placed.push_back({{}, evolution::Chromosome{organism.genes.data()}, organism.tick});
    }
    append(placed, parameters);
    fate_ = state.fate;
    for (std::uint32_t i = 0; i < crate_count_; ++i) {
        boxes_.x[i] = state.crates[i].x;
        boxes_.y[i] = state.crates[i].y;
        boxes_.velocity_x[i] = state.crates[i].velocity_x;
        boxes_.velocity_y[i] = state.crates[i].velocity_y;
    }
    food_.restore(state.food, executor);
    poison_.restore(state.poison, executor);
    // At the beginning of a generation, the index of every organism equals its id.
    std::vector<std::uint32_t> gone;
    for (std::uint32_t id = 0; id < body_of_.size(); ++id) {
        if (fate_.cause[id] != CauseOfDeath::Alive) {
            gone.push_back(id);
            continue;
        }
        const IslandState::Organism& organism = state.organisms[id];
        bodies_.x[id] = organism.x;
        bodies_.y[id] = organism.y;
        bodies_.velocity_x[id] = organism.velocity_x;
        bodies_.velocity_y[id] = organism.velocity_y;
        living_.health[id] = organism.health;
    }
    perception_.begin(bodies_, living_, food_, poison_);
    for (const std::uint32_t id : gone) {
        body_of_[id] = no_body;
        bodies_.remove(id);
        perception_.remove(id);
        living_.health[id] = -std::numeric_limits<float>::infinity();
    }
    alive_count_ -= static_cast<std::uint32_t>(gone.size());
    hash_ = whole_hash();
    if (tick == 0) {
        hash_ -= uncovered;
    }
}

base::StateHash Island::whole_hash() const {
    base::StateHash hash = born_hash_ + food_.hash() + poison_.hash() + hash_of_boxes();
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
        if (!bodies_.is_void(body)) {
            hash += hash_of_organism(bodies_, living_, body);
        }
    }
    return hash;
}

std::vector<double> Island::fitness(const parameters::Parameters& parameters, std::uint32_t tick,
                                    base::Executor& executor) const {
    const auto organisms = static_cast<std::size_t>(born_.genes.cols());
    std::vector<double> fitness(organisms);
    if (parameters.fitness == parameters::FitnessFunction::Life) {
        executor.parallel_for(organisms, organisms_per_block, [&](base::Range range) {
            for (std::size_t id = range.begin; id < range.end; ++id) {
                const std::uint32_t placed = placed_tick(static_cast<std::uint32_t>(id));
                fitness[id] = body_of_[id] == no_body ? fate_.lived_ticks[id] * parameters.tick_s
                                                      : (tick - placed) * parameters.tick_s +
                                                            static_cast<double>(living_.health[body_of_[id]]);
            }
        });
        return fitness;
    }
    const auto function = parameters.fitness == parameters::FitnessFunction::GeneSum ? gene_sum : rastrigin;
    executor.parallel_for(organisms, organisms_per_block, [&](base::Range range) {
        for (std::size_t id = range.begin; id < range.end; ++id) {
            fitness[id] = function(born_.genes.col(static_cast<Eigen::Index>(id)));
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
    predict_intentions(bodies_, living_, food_, poison_, behaviour_rules(parameters), behaviour_key_, tick,
                       asked_bodies, of_living);
    std::vector<Intention> intentions(ids.end - ids.begin);
    for (std::size_t k = 0; k < asked_bodies.size(); ++k) {
        intentions[bodies_.id[asked_bodies[k]] - ids.begin] = of_living[k];
    }
    return intentions;
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
            .poisoned_count = counts_.poisoned_count};
}

LiveStatistics Island::live_statistics() const {
    LiveStatistics live = live_counts();
    live.health_mean = mean_health(std::span{living_.health}.first(bodies_.size()), alive_count_);
    return live;
}

} // namespace evod::simulation
