// Meals: what organisms eat in a tick, and which of them die. ItemClaims has found which body touches which item.
#include "server/simulation/island.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace evod::simulation {

base::StateHash Island::feed_and_remove_dead(const parameters::Parameters& parameters, std::uint32_t tick,
                                             base::Executor& executor) {
    // Organisms are processed in blocks, in parallel. The grids of items are then changed sequentially.
    constexpr std::size_t events_worth_dividing = 128;
    std::size_t events = food_claims_.award() + poison_claims_.award();
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
        eaten_hash_ += block.eaten_hash_change;
        counts_.food_eaten += block.food_eaten;
        counts_.poison_eaten += block.poison_eaten;
        counts_.starved_count += block.starved;
        counts_.poisoned_count += block.poisoned;
        alive_count_ -= block.starved + block.poisoned;
        if (is_colony()) {
            add_deaths(block);
        }
    }
    const auto take_out = [this](Items& items, const ItemClaims& claims) {
        constexpr std::size_t blocks_ahead = 4;
        for (std::size_t block = 0; block < blocks_.size(); ++block) {
            if (block + blocks_ahead < blocks_.size()) {
                for (const Touch& touch : claims.touches(block + blocks_ahead)) {
                    items.prefetch_place(touch.place);
                }
            }
            for (const Touch& touch : claims.touches(block)) {
                if (touch.gets_it) {
                    items.take_out(touch.item, touch.place);
                }
            }
        }
    };
    for_each_kind(
        executor, [&] { take_out(food_, food_claims_); }, [&] { take_out(poison_, poison_claims_); });
    return organisms;
}

void Island::feed_and_remove_dead_in_block(const parameters::Parameters& parameters, std::uint32_t tick,
                                           std::size_t index) {
    Block& block = blocks_[index];
    block.food_hash_change = block.poison_hash_change = block.eaten_hash_change = {};
    block.food_eaten = block.poison_eaten = block.starved = block.poisoned = 0;
    block.deaths = {};
    for (const Touch& touch : food_claims_.touches(index)) {
        food_.prefetch_item(touch.item);
        __builtin_prefetch(&life_records_.food_eaten[touch.id], 1);
        __builtin_prefetch(&bodies_.id[touch.body]);
        __builtin_prefetch(&bodies_.x[touch.body]);
        __builtin_prefetch(&bodies_.y[touch.body]);
        __builtin_prefetch(&bodies_.velocity_x[touch.body]);
        __builtin_prefetch(&bodies_.velocity_y[touch.body]);
        __builtin_prefetch(&living_.health[touch.body], 1);
    }
    // All food is eaten before all poison. Items of one kind are equal, so their order does not matter.
    for (const Touch& touch : food_claims_.touches(index)) {
        if (!touch.gets_it) {
            continue;
        }
        const float cap = parameters.health_cap_per_size > 0
                              ? health_cap(evolution::body_genes(born_.genes, touch.id), parameters)
                              : std::numeric_limits<float>::infinity();
        change_health(block, touch.body,
                      [&](float health) { return std::min(health + static_cast<float>(parameters.food_health), cap); });
        block.food_hash_change += food_.set_due(touch.item, tick);
        count_eaten(block, touch.id, life_records_.food_eaten, food_counts_);
        ++block.food_eaten;
    }
    for (const Touch& touch : poison_claims_.touches(index)) {
        if (!touch.gets_it) {
            continue;
        }
        change_health(block, touch.body,
                      [&](float health) { return health - static_cast<float>(parameters.poison_harm); });
        block.poison_hash_change += poison_.set_due(touch.item, tick);
        count_eaten(block, touch.id, life_records_.poison_eaten, poison_counts_);
        ++block.poison_eaten;
    }
    // The cost of living is subtracted at the beginning of a tick, and poison at its end. If a dying organism ate
    // poison in this tick, poison was therefore the cause of death.
    for (const Touch& touch : poison_claims_.touches(index)) {
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
    if (lifespan_ticks_[0] > 0 || lifespan_ticks_[1] > 0) {
        const base::Range range = physics::circles_of_block(bodies_.size(), index);
        for (std::size_t body = range.begin; body < range.end; ++body) {
            if (living_.dies_in[body] <= tick && !bodies_.is_void(body)) {
                record_death(block, static_cast<std::uint32_t>(body), tick, CauseOfDeath::Old);
            }
        }
    }
}

void Island::add_deaths(const Block& block) {
    for (std::size_t species = 0; species < colony_.size(); ++species) {
        ColonyCounts& counts = colony_[species];
        const Block::Deaths& deaths = block.deaths[species];
        const auto of = [&](CauseOfDeath cause) { return deaths[static_cast<std::size_t>(cause)]; };
        counts.starved += of(CauseOfDeath::Starved);
        counts.poisoned += of(CauseOfDeath::Poisoned);
        counts.eaten += of(CauseOfDeath::Eaten);
        counts.old += of(CauseOfDeath::Old);
        counts.living -= std::accumulate(deaths.begin(), deaths.end(), 0u);
        alive_count_ -= of(CauseOfDeath::Eaten) + of(CauseOfDeath::Old);
    }
}

template <class Change>
void Island::change_health(Block& block, std::uint32_t body, Change&& change) {
    block.hash -= hash_of_organism(bodies_, living_, body);
    living_.health[body] = change(living_.health[body]);
    block.hash += hash_of_organism(bodies_, living_, body);
}

void Island::count_eaten(Block& block, std::uint32_t id, std::vector<std::uint32_t>& eaten, bool counts) {
    if (!counts) {
        ++eaten[id];
        return;
    }
    block.eaten_hash_change -= hash_of_eaten(id);
    ++eaten[id];
    block.eaten_hash_change += hash_of_eaten(id);
}

base::StateHash Island::hash_of_eaten(std::uint32_t id) const {
    constexpr std::uint32_t eaten_kind = 6; // the hashes of every run depend on it
    const std::uint32_t food = food_counts_ ? life_records_.food_eaten[id] : 0;
    const std::uint32_t poison = poison_counts_ ? life_records_.poison_eaten[id] : 0;
    return food == 0 && poison == 0 ? base::StateHash{} : base::EntityHash{eaten_kind, id}.add(food, poison).finish();
}

bool Island::is_dying(std::uint32_t body) const {
    return !bodies_.is_void(body) && living_.health[body] <= 0;
}

void Island::record_death(Block& block, std::uint32_t body, std::uint32_t tick, CauseOfDeath cause) {
    const std::uint32_t id = bodies_.id[body];
    life_records_.cause[id] = cause;
    life_records_.lived_ticks[id] = tick - placed_tick(id);
    if (is_colony()) {
        ++block.deaths[static_cast<std::size_t>(species_of(id))][static_cast<std::size_t>(cause)];
    }
    block.hash -= hash_of_organism(bodies_, living_, body);
    body_of_[id] = no_body;
    bodies_.remove(body);
    perception_.remove(body);
    stepper_.near().remove(body);
    living_.health[body] = -std::numeric_limits<float>::infinity();
}

// Predation. A predator that handles no prey claims the nearest living prey that it reaches; equal distances: the
// lowest id. It reaches a little beyond its body, because contacts push bodies apart until they just do not touch. A
// prey that several predators claim goes to the nearest of them; the others get nothing. Prey that died of poison,
// starvation or age in the same tick are dead already.

std::uint32_t Island::reached_prey(std::uint32_t predator, std::uint32_t tick) const {
    if (bodies_.is_void(predator) || living_.hunts_from[predator] > tick) {
        return BodyGrid::none;
    }
    const physics::Coordinate x = bodies_.x[predator], y = bodies_.y[predator];
    constexpr float beyond_px = 1;
    const float radius = bodies_.radius[predator] + beyond_px;
    return hunt_.prey().nearest(bodies_, x, y, radius + hunt_.widest_prey_px(), [&](std::uint32_t prey) {
        const float dx = physics::distance_px(x, bodies_.x[prey]), dy = physics::distance_px(y, bodies_.y[prey]);
        const float reach = radius + bodies_.radius[prey];
        return dx * dx + dy * dy <= reach * reach;
    });
}

base::StateHash Island::eat_prey(const parameters::Parameters& parameters, std::uint32_t tick,
                                 base::Executor& executor) {
    locate();
    const std::span<const std::uint32_t> predators = hunt_.predators().members();
    std::vector<std::uint32_t> claimed(predators.size());
    constexpr std::size_t predators_per_piece = 256;
    executor.parallel_for(predators.size(), predators_per_piece, [&](base::Range range) {
        for (std::size_t k = range.begin; k < range.end; ++k) {
            claimed[k] = reached_prey(predators[k], tick);
        }
    });

    struct Claim {
        std::uint32_t prey;
        float square;
        std::uint32_t id, predator;
    };
    std::vector<Claim> claims;
    for (std::size_t k = 0; k < predators.size(); ++k) {
        if (const std::uint32_t prey = claimed[k]; prey != BodyGrid::none) {
            const std::uint32_t predator = predators[k];
            const float dx = physics::distance_px(bodies_.x[predator], bodies_.x[prey]),
                        dy = physics::distance_px(bodies_.y[predator], bodies_.y[prey]);
            claims.push_back({prey, dx * dx + dy * dy, bodies_.id[predator], predator});
        }
    }
    std::ranges::sort(claims, {}, [](const Claim& claim) { return std::tuple{claim.prey, claim.square, claim.id}; });
    const auto is_same_prey = [](const Claim& a, const Claim& b) { return a.prey == b.prey; };
    claims.erase(std::unique(claims.begin(), claims.end(), is_same_prey), claims.end());

    const auto handling_ticks = static_cast<std::uint32_t>(std::ceil(parameters.handling_s / parameters.tick_s - 1e-6));
    Block block;
    for (const Claim& claim : claims) {
        record_death(block, claim.prey, tick, CauseOfDeath::Eaten);
        const float cap = parameters.health_cap_per_size > 0
                              ? health_cap(evolution::body_genes(born_.genes, claim.id), parameters)
                              : std::numeric_limits<float>::infinity();
        change_health(block, claim.predator, [&](float health) {
            return std::max(health, std::min(health + static_cast<float>(parameters.prey_health), cap));
        });
        count_eaten(block, claim.id, life_records_.food_eaten, food_counts_);
        living_.hunts_from[claim.predator] = tick + 1 + handling_ticks;
    }
    for (const std::uint32_t predator : predators) {
        if (living_.hunts_from[predator] <= tick + 1) {
            living_.hunts_from[predator] = 0; // it hunts in the next tick
        }
    }
    eaten_hash_ += block.eaten_hash_change;
    add_deaths(block);
    return block.hash;
}

} // namespace evod::simulation
