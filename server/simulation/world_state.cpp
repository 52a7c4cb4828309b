#include "server/simulation/world_state.h"

#include "server/base/assert.h"
#include "server/simulation/rating.h"
#include "server/simulation/world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>

namespace evod::simulation {
namespace {

/// No parameter allows a gene of the body, or the gene body_size, above these values.
constexpr float gene_reachable = 10'000, body_size_reachable = 1'000;

} // namespace

IslandShape Island::shape() const {
    return {.genes = static_cast<std::uint32_t>(born_.genes.rows()),
            .organisms = bred_count(),
            .has_bodies = has_bodies(),
            .has_headings = has_bodies() && living_.has_brains(),
            .is_colony = has_bodies() && is_colony(),
            .crates = has_bodies() ? crate_count_ : 0,
            .food = has_bodies() ? food_.first_count() : 0,
            .poison = has_bodies() ? poison_.first_count() : 0};
}

IslandState Island::state(base::Executor& executor) const {
    IslandState state;
    state.life_records = life_records_;
    state.counts = counts_;
    if (!has_bodies()) {
        return state;
    }
    for (std::uint32_t id = bred_count(); id < life_records_.cause.size(); ++id) {
        const evolution::ConstGenes genes = evolution::column(born_.genes, id);
        state.placed.push_back(
            {.genes = {genes.begin(), genes.end()}, .tick = placed_tick(id), .parents = parents_of_child(id)});
    }
    state.colony = colony_;
    state.latest_born = latest_born_;
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
                state.headings.resize(living_.has_brains() ? body_of_.size() : 0);
                state.hunts_from.resize(is_colony() ? body_of_.size() : 0);
            }
        }
    });
    executor.parallel_for(bodies_.size(), organisms_per_block, [&](base::Range range) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            if (!bodies_.is_void(i)) {
                state.organisms[bodies_.id[i]] = {bodies_.x[i], bodies_.y[i], bodies_.velocity_x[i],
                                                  bodies_.velocity_y[i], living_.health[i]};
                if (living_.has_brains()) {
                    state.headings[bodies_.id[i]] = living_.heading[i];
                }
                if (is_colony()) {
                    state.hunts_from[bodies_.id[i]] = living_.hunts_from[i];
                }
            }
        }
    });
    return state;
}

bool can_live_with(evolution::ConstGenes genes) {
    const auto is_body_gene = [](float gene) { return gene >= 0 && gene <= gene_reachable; };
    return std::ranges::all_of(genes.first<evolution::body_gene_count>(), is_body_gene) &&
           std::ranges::all_of(genes, [](float gene) { return std::isfinite(gene); }) &&
           genes[evolution::BodySize] > 0 && genes[evolution::BodySize] <= body_size_reachable;
}

bool are_chromosomes(std::span<const float> genes, std::size_t gene_count) {
    for (; !genes.empty(); genes = genes.subspan(gene_count)) {
        if (genes.size() < gene_count || !can_live_with(genes.first(gene_count))) {
            return false;
        }
    }
    return true;
}

const char* Island::fault_of_arrivals(const IslandState& state, std::uint32_t tick) const {
    for (const IslandState::Placed& placed : state.placed) {
        if (placed.tick > tick || placed.genes.size() != static_cast<std::size_t>(born_.genes.rows()) ||
            !can_live_with(placed.genes)) {
            return "a placed organism";
        }
        const auto id = std::size_t{shape().organisms} + static_cast<std::size_t>(&placed - state.placed.data());
        if ((placed.parents.first != no_parents.first || placed.parents.second != no_parents.second) &&
            (!has_births_ || placed.parents.first >= id || placed.parents.second >= id)) {
            return "the parents of a child";
        }
    }
    for (const std::vector<float>& latest : state.latest_born) {
        if (!are_chromosomes(latest, static_cast<std::size_t>(born_.genes.rows()))) {
            return "the latest births";
        }
    }
    return nullptr;
}

base::Result<void> Island::check(const IslandState& state, std::uint32_t tick) const {
    const auto wrong = [this](const std::string& what) {
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = "island " + std::to_string(index_) + ": impossible state: " + what,
                             .violations = {}};
    };
    const LifeRecords& life_records = state.life_records;
    const IslandShape own = shape();
    const std::size_t organisms = own.organisms + state.placed.size();
    if (life_records.cause.size() != organisms || life_records.lived_ticks.size() != organisms ||
        life_records.food_eaten.size() != organisms || life_records.poison_eaten.size() != organisms ||
        state.organisms.size() != (own.has_bodies ? organisms : 0) ||
        state.headings.size() != (own.has_headings ? organisms : 0) ||
        state.hunts_from.size() != (own.is_colony ? organisms : 0) ||
        life_records.children.size() != (own.is_colony ? organisms : 0) ||
        (!has_births_ && state.placed.size() > placed_max) || (!own.has_bodies && !state.placed.empty())) {
        return wrong("number of organisms");
    }
    if (const char* fault = fault_of_arrivals(state, tick)) {
        return wrong(fault);
    }
    if (state.crates.size() != own.crates) {
        return wrong("number of crates");
    }

    const auto moves = [&](const auto& body) {
        return can_move(body, area_.width, area_.height, step_parameters_.max_speed_px_s);
    };
    std::uint32_t alive = 0, starved = 0, poisoned = 0;
    for (std::size_t id = 0; id < organisms; ++id) {
        const auto which = [&](const char* what) { return wrong(what + (" of organism " + std::to_string(id))); };
        if (life_records.cause[id] == CauseOfDeath::Alive) {
            if (life_records.lived_ticks[id] != 0) {
                return which("lived_ticks");
            }
            if (!own.has_bodies) {
                continue;
            }
            ++alive;
            const IslandState::Organism& organism = state.organisms[id];
            if (!moves(organism)) {
                return which("position or speed");
            }
            if (own.has_headings && !(std::abs(state.headings[id]) <= heading_max)) {
                return which("heading");
            }
            const bool has_lived = tick > (id < own.organisms ? 0 : state.placed[id - own.organisms].tick);
            if (!(std::abs(organism.health) <= health_reachable) || (organism.health <= 0 && has_lived)) {
                return which("health");
            }
            continue;
        }
        starved += life_records.cause[id] == CauseOfDeath::Starved;
        poisoned += life_records.cause[id] == CauseOfDeath::Poisoned;
        const bool removed = life_records.cause[id] == CauseOfDeath::Removed;
        if (!own.has_bodies || life_records.cause[id] > (own.is_colony ? CauseOfDeath::Old : CauseOfDeath::Removed) ||
            (life_records.lived_ticks[id] == 0 && !removed) || life_records.lived_ticks[id] > tick ||
            state.organisms[id] != IslandState::Organism{} || (own.has_headings && state.headings[id] != 0)) {
            return which("death");
        }
    }
    if (own.is_colony && state.colony[0].living + state.colony[1].living != alive) {
        return wrong("number of living organisms");
    }
    if (starved != state.counts.starved_count || poisoned != state.counts.poisoned_count) {
        return wrong("number of dead organisms");
    }
    if (!std::ranges::all_of(state.crates, moves)) {
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
        const bool has_turned = !begun.headings.empty() && state.headings[id] != begun.headings[id];
        if (state.life_records.cause[id] != CauseOfDeath::Removed &&
            (state.organisms[id] != begun.organisms[id] || has_turned)) {
            return false;
        }
    }
    const auto has_eaten = [](std::uint32_t count) { return count > 0; };
    return state.counts == begun.counts && state.crates == begun.crates && are_kept(begun.food, state.food) &&
           are_kept(begun.poison, state.poison) && std::ranges::none_of(state.life_records.food_eaten, has_eaten) &&
           std::ranges::none_of(state.life_records.poison_eaten, has_eaten);
}

void Island::restore(const IslandState& state, std::uint32_t tick, const parameters::Parameters& parameters,
                     base::Executor& executor) {
    counts_ = state.counts;
    if (!has_bodies()) {
        life_records_ = state.life_records;
        return;
    }
    // Before the first tick, hash_ covers only the chromosomes and what commands have changed.
    base::StateHash uncovered;
    if (tick == 0) {
        uncovered = whole_hash();
        uncovered -= hash_;
    }
    std::vector<NewOrganism> placed; // with the positions that the loop over all organisms sets
    for (const IslandState::Placed& organism : state.placed) {
        placed.push_back({{}, organism.genes, organism.tick, organism.parents});
    }
    append(placed, parameters);
    life_records_ = state.life_records;
    colony_ = state.colony;
    latest_born_ = state.latest_born;
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
    eaten_hash_ = {};
    for (std::uint32_t id = 0; id < body_of_.size(); ++id) {
        eaten_hash_ += hash_of_eaten(id);
        if (life_records_.cause[id] != CauseOfDeath::Alive) {
            gone.push_back(id);
            continue;
        }
        const IslandState::Organism& organism = state.organisms[id];
        bodies_.x[id] = organism.x;
        bodies_.y[id] = organism.y;
        bodies_.velocity_x[id] = organism.velocity_x;
        bodies_.velocity_y[id] = organism.velocity_y;
        living_.health[id] = organism.health;
        if (living_.has_brains()) {
            living_.heading[id] = state.headings[id];
        }
        if (is_colony()) {
            living_.hunts_from[id] = state.hunts_from[id];
        }
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
    hash_ -= uncovered;
}

WorldState World::state(base::Executor& executor) const {
    WorldState state{.moment = moment_,
                     .parameters = parameters(),
                     .islands = islands_->states(executor),
                     .ended = {},
                     .ratings = ratings_};
    if (generation_over_) {
        state.ended = history_.back();
    }
    return state;
}

std::vector<IslandShape> World::shapes() const {
    std::vector<IslandShape> shapes;
    for (const Island& island : *islands_) {
        shapes.push_back(island.shape());
    }
    return shapes;
}

base::Result<void> World::restore(const WorldState& state, base::Executor& executor) {
    EVOD_ASSERT(moment_.generation_tick == 0);
    const auto wrong = [](const char* what) {
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = std::string{"impossible state for this generation: wrong "} + what,
                             .violations = {}};
    };
    const Moment& moment = state.moment;
    const parameters::ParameterSet& set = state.parameters;
    if (moment.generation != moment_.generation || moment.tick < moment_.tick ||
        moment.tick - moment_.tick != moment.generation_tick || !std::isfinite(moment.simulated_s) ||
        moment.simulated_s < moment_.simulated_s) {
        return wrong("moment");
    }
    // Parameters that take effect at a generation must still have the values from the beginning of this generation.
    if (!(parameters::taking_effect(parameters_.active(), parameters::RequestedParameters{set.active},
                                    base::Effect::NextTick) == set.active) ||
        !parameters::validate(set.active).empty() ||
        !parameters::validate(parameters::taking_effect(set.active, set.requested, base::Effect::NextGeneration))
             .empty()) {
        return wrong("parameters");
    }
    if (state.islands.size() != islands_->size()) {
        return wrong("number of islands");
    }
    // No tick of a generation follows its last one, so the previous tick must not have ended the generation.
    if (moment.generation_tick > 1 && ends(moment.generation_tick - 1, 1)) {
        return wrong("moment");
    }
    const auto tick = static_cast<std::uint32_t>(moment.generation_tick);
    std::uint64_t alive = 0, removed = 0;
    for (std::size_t i = 0; i < islands_->size(); ++i) {
        if (auto checked = island(i).check(state.islands[i], tick); !checked) {
            return checked;
        }
        if (tick == 0 && !differ_only_by_commands(island(i).state(executor), state.islands[i])) {
            return wrong("beginning of the generation");
        }
        alive +=
            static_cast<std::uint64_t>(std::ranges::count(state.islands[i].life_records.cause, CauseOfDeath::Alive));
        removed +=
            static_cast<std::uint64_t>(std::ranges::count(state.islands[i].life_records.cause, CauseOfDeath::Removed));
    }
    // If a command has removed the last living organism after this tick, the generation ends with the next tick.
    const bool removed_last =
        alive == 0 && removed > 0 && state.ended.empty() && state.ratings.empty() && !ends(tick, 1);
    const bool after_last_tick = ends(tick, alive) && !removed_last;
    if (!can_be_given(state, after_last_tick && set.active.fitness == parameters::FitnessFunction::External)) {
        return wrong("fitness");
    }
    const bool over = after_last_tick && is_whole(state);
    if (state.ended.size() != (over ? islands_->size() : 0)) {
        return wrong("end of the generation");
    }
    for (std::size_t i = 0; i < state.ended.size(); ++i) {
        if (state.ended[i].generation != moment.generation || state.ended[i].island != i ||
            !std::isfinite(state.ended[i].fitness_best)) {
            return wrong("statistics");
        }
    }

    islands_->restore(parameters_.active(), state, executor);
    moment_ = state.moment;
    parameters_.restore(state.parameters);
    ratings_ = state.ratings;
    if (!state.ended.empty()) {
        std::vector<GenerationStatistics> ended = state.ended;
        for (std::size_t i = 0; i < ended.size(); ++i) {
            ended[i].account = island(i).born().account; // can be derived from the generation's beginning
            for (GenerationStatistics& predators : ended[i].predators) {
                predators.account = island(i).born().predator_account;
            }
        }
        close_generation(ended);
    }
    update_hash();
    return {};
}

} // namespace evod::simulation
