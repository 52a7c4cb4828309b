#include "server/simulation/world.h"

#include "server/base/assert.h"
#include "server/base/inline_executor.h"
#include "server/evolution/migration.h"
#include "server/simulation/rating.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace evod::simulation {

World::World(const parameters::ParameterSet& set, base::Seed seed, FirstPopulation first_population,
             parameters::Schedule schedule, IslandsMaker* maker)
    : seed_{seed}
    , parameters_{set, std::move(schedule)}
    , first_population_{std::move(first_population)}
    , islands_{make_islands(seed, set.active.island_count, maker)} {
    BredIslands bred;
    if (first_population_) {
        EVOD_ASSERT(first_population_->size() == set.active.island_count);
        for (const evolution::GeneMatrix& genes : *first_population_) {
            bred.islands.push_back({.genes = genes, .parents = {}});
        }
    }
    base::InlineExecutor executor; // a run begins between two ticks, where no executor is available
    islands_->begin_generation(set.active, moment_.generation, std::move(bred), executor);
    open();
}

World::World(base::Seed seed, const Opening& opening, BredIslands bred, History history, base::Executor& executor,
             FirstPopulation first_population, parameters::Schedule schedule, IslandsMaker* maker)
    : seed_{seed}
    , parameters_{opening.parameters, std::move(schedule)}
    , first_population_{std::move(first_population)}
    , moment_{opening.moment}
    , islands_{make_islands(seed, opening.parameters.active.island_count, maker)}
    , history_{std::move(history)}
    , progress_{opening.progress} {
    EVOD_ASSERT(bred.islands.size() == opening.parameters.active.island_count);
    EVOD_ASSERT(moment_.generation_tick == 0);
    islands_->begin_generation(opening.parameters.active, moment_.generation, std::move(bred), executor);
    open();
}

World::World(const World& original, std::unique_ptr<Islands> islands)
    : seed_{original.seed_}
    , parameters_{original.parameters_}
    , first_population_{original.first_population_}
    , moment_{original.moment_}
    , generation_over_{original.generation_over_}
    , hash_{original.hash_}
    , islands_{std::move(islands)}
    , opening_{original.opening_}
    , history_{original.history_}
    , ratings_{original.ratings_}
    , progress_{original.progress_} {}

void World::open() {
    opening_ = {moment_, parameters_.set(), progress_};
    ratings_.clear();
    update_hash();
}

World World::copy(base::Executor& executor, IslandsMaker* maker) const {
    const bool is_divided = maker != nullptr && maker->divides(island_count());
    std::unique_ptr<Islands> islands = is_divided ? nullptr : islands_->copy();
    if (islands == nullptr) {
        const parameters::Parameters& begun_with = opening_.parameters.active;
        islands = make_islands(seed_, island_count(), maker);
        islands->begin_generation(begun_with, moment_.generation, bred(), executor);
        islands->restore(begun_with, state(executor), executor);
    }
    return {*this, std::move(islands)};
}

World World::at_its_opening(base::Executor& executor) const {
    History before = history_;
    while (!before.empty() && before.back().front().generation >= opening_.moment.generation) {
        before.pop_back();
    }
    return {seed_, opening_, bred(), std::move(before), executor, first_population_, schedule(), islands_->maker()};
}

void World::become_fork() {
    parameters_.become_fork();
    const auto is_inherited = [&](const GenerationRows& rows) {
        return rows.front().generation + history_generations_inherited >= opening_.moment.generation;
    };
    while (!history_.empty() && !is_inherited(history_.front())) {
        history_.pop_front();
    }
}

base::Result<parameters::Parameters> World::beginning(const std::optional<evolution::FreeGenes>& listed_genes) const {
    parameters::Parameters requested = parameters().requested.values;
    if (listed_genes) {
        requested.listed_genes = *listed_genes;
        requested.free_genes = listed_genes->empty() ? requested.free_genes : listed_genes->gene_count();
    }
    return parameters::assign(requested, schedule().at(1));
}

World World::restarted(base::Seed seed, const std::optional<evolution::FreeGenes>& listed_genes,
                       IslandsMaker* maker) const {
    return {parameters::ParameterSet::all_in_effect(beginning(listed_genes).value(), parameters().revision), seed,
            first_population_, schedule(), maker};
}

evolution::Outcome World::outcome() const {
    const parameters::Parameters& p = parameters_.active();
    return generation_over_ ? evolution::outcome(progress_, p, parameters::has_births(p)) : evolution::Outcome::Running;
}

std::vector<IslandOutcome> World::outcomes() const {
    EVOD_ASSERT(generation_over_);
    return islands_->outcomes();
}

std::vector<Intention> World::intentions(const Island& island, base::Range ids) const {
    if (is_after_last_tick()) {
        return std::vector<Intention>(ids.end - ids.begin);
    }
    return island.intentions(parameters_.active_in_next_tick(moment_),
                             static_cast<std::uint32_t>(moment_.generation_tick) + 1, ids);
}

std::optional<Activations> World::activations(const Island& island, std::uint32_t id) const {
    if (is_after_last_tick()) {
        return std::nullopt;
    }
    return island.activations(parameters_.active_in_next_tick(moment_),
                              static_cast<std::uint32_t>(moment_.generation_tick) + 1, id);
}

std::uint64_t World::alive_count() const {
    std::uint64_t alive = 0;
    for (const IslandSummary& island : islands_->summaries()) {
        alive += island.alive_count;
    }
    return alive;
}

EntityIds World::place(const PlaceEntities& command) {
    EntityIds ids = islands_->place(command, parameters_.active(), static_cast<std::uint32_t>(moment_.generation_tick));
    ids.island = command.island;
    ids.generation = moment_.generation;
    update_hash();
    return ids;
}

EntityIds World::remove(const RemoveEntities& command) {
    islands_->remove(command, static_cast<std::uint32_t>(moment_.generation_tick));
    if (!command.organisms.empty() && islands_->summaries()[command.island].alive_count == 0) {
        events_.emplace_back(
            Extinction{.island = command.island, .generation = moment_.generation, .tick = moment_.tick});
    }
    update_hash();
    return {command.island, moment_.generation, command.food, command.poison, command.organisms};
}

bool World::is_as_begun() const {
    return moment_.generation_tick == 0 && parameters() == opening_.parameters &&
           std::ranges::all_of(islands_->summaries(), &IslandSummary::is_as_begun);
}

void World::breed_next_generation(base::Executor& executor) {
    if (!generation_over_) {
        return;
    }
    parameters_.begin_breeding(moment_.generation + 1, events_);
    const parameters::Parameters& p = parameters_.active();
    Routes routes;
    if (evolution::migration_due(moment_.generation, p)) {
        routes.prey = routes_of(Species::Prey, p);
        if (p.predator_count > 0) {
            routes.predators = routes_of(Species::Predator, parameters::of_predators(p));
        }
    }
    islands_->breed_next_generation(p, moment_.generation, static_cast<std::uint32_t>(moment_.generation_tick), routes,
                                    executor);
    if (!routes.empty()) {
        MigrationHappened happened{.generation = moment_.generation, .edges = {}};
        for (const auto* of_species : {&routes.prey, &routes.predators}) {
            for (const evolution::MigrationRoute& route : *of_species) {
                happened.edges.push_back({route.from, route.to, route.count});
            }
        }
        events_.emplace_back(std::move(happened));
    }
    ++moment_.generation;
    moment_.generation_tick = 0;
    generation_over_ = false;
    open();
}

std::vector<evolution::MigrationRoute> World::routes_of(Species species,
                                                        const parameters::Parameters& parameters) const {
    std::vector<std::uint32_t> populations;
    for (const IslandSummary& island : islands_->summaries()) {
        populations.push_back(island.breeder_counts[static_cast<std::size_t>(species)]);
    }
    auto routes = evolution::plan_migration(populations, parameters, seed_, migration_key(moment_.generation, species));
    std::erase_if(routes, [](const evolution::MigrationRoute& route) { return route.count == 0; });
    return routes;
}

bool World::has_died_out() const {
    const parameters::Parameters& p = parameters_.active();
    if (!has_bodies() || !parameters::has_births(p)) {
        return has_bodies() && alive_count() == 0;
    }
    evolution::LivingSpecies living{.predators_have_come =
                                        p.predator_count > 0 && moment_.generation >= p.predator_from};
    for (const IslandSummary& island : islands_->summaries()) {
        living.prey += island.breeder_counts[0];
        living.predators += island.breeder_counts[1];
    }
    return evolution::has_died_out(living, p);
}

void World::advance(std::uint64_t tick, base::Executor& executor) {
    EVOD_ASSERT(tick > moment_.tick);
    EVOD_ASSERT(outcome() == evolution::Outcome::Running);
    EVOD_ASSERT(!awaits_fitness());
    if (generation_over_) {
        breed_next_generation(executor);
    }
    if (moment_.generation_tick == 0) {
        parameters_.begin_tick();
    }
    const parameters::Parameters& p = parameters_.active();
    bool has_ended = false;
    for (;;) {
        const std::uint64_t stop = parameters_.next_stop(tick);
        EVOD_ASSERT(stop > moment_.tick);
        const std::uint64_t wanted = moment_.generation_tick + (stop - moment_.tick);
        const auto first = static_cast<std::uint32_t>(moment_.generation_tick + 1);
        Advanced advanced{.tick = first, .alive_count = 0};
        if (has_bodies()) {
            const std::uint64_t last = wanted == first ? first : std::min(wanted, last_tick());
            std::vector<DiedOut> died_out;
            advanced =
                islands_->advance(p, {first, static_cast<std::uint32_t>(std::clamp<std::uint64_t>(last, first, ~0U))},
                                  executor, died_out);
            for (const DiedOut& island : died_out) {
                events_.emplace_back(Extinction{.island = island.island,
                                                .generation = moment_.generation,
                                                .tick = moment_.tick + (island.tick - first + 1)});
            }
        }
        for (; moment_.generation_tick < advanced.tick; ++moment_.generation_tick) {
            ++moment_.tick;
            moment_.simulated_s += p.tick_s;
        }
        has_ended = ends(moment_.generation_tick, advanced.alive_count);
        if (has_ended || moment_.tick == tick) {
            break;
        }
        parameters_.end_tick(moment_.tick, moment_.generation, events_);
    }
    update_hash();
    if (has_ended && p.fitness == parameters::FitnessFunction::External) {
        ratings_.resize(islands_->size());
        events_.emplace_back(FitnessAwaited{moment_.generation});
    } else if (has_ended) {
        finish_generation(executor);
    }
    parameters_.end_tick(moment_.tick, generation_of_changes(), events_);
}

// The half tick is a tolerance, so that 40 s are exactly 2,400 ticks of 1/60 s despite rounding.
std::uint64_t World::last_tick() const {
    return static_cast<std::uint64_t>(
        std::floor(parameters_.active().generation_s / parameters_.active().tick_s + 0.5));
}

bool World::ends(std::uint64_t generation_tick, std::uint64_t alive) const {
    const parameters::Parameters& p = parameters_.active();
    return generation_tick > 0 &&
           (alive == 0 || !has_bodies() || static_cast<double>(generation_tick) + 0.5 > p.generation_s / p.tick_s);
}

void World::finish_generation(base::Executor& executor) {
    const parameters::Parameters& p = parameters_.active();
    std::vector<GenerationStatistics> statistics =
        islands_->end_generation(p, static_cast<std::uint32_t>(moment_.generation_tick), ratings_, executor);
    for (GenerationStatistics& island : statistics) {
        island.generation = moment_.generation;
        island.end_tick = moment_.tick;
        island.simulated_s = static_cast<double>(moment_.generation_tick) * p.tick_s;
        for (GenerationStatistics& predators : island.predators) {
            predators.generation = island.generation;
            predators.end_tick = island.end_tick;
            predators.simulated_s = island.simulated_s;
        }
    }
    close_generation(statistics);
    events_.emplace_back(GenerationFinished{std::move(statistics)});
    if (const evolution::Outcome reached = outcome(); reached != evolution::Outcome::Running) {
        events_.emplace_back(RunTerminated{reached});
    }
}

void World::close_generation(const std::vector<GenerationStatistics>& statistics) {
    generation_over_ = true;
    const double best = std::ranges::max(statistics, {}, &GenerationStatistics::fitness_best).fitness_best;
    progress_ = evolution::advance(progress_, {.best_fitness = best, .died_out = has_died_out()});
    history_.push_back(statistics);
    if (history_.size() > history_generations_kept_of(islands_->size(), evolution::gene_count(parameters_.active()))) {
        history_.pop_front();
    }
}

void World::update_hash() {
    constexpr std::uint32_t world_kind = 100, island_kind = 101;
    hash_ = base::EntityHash{world_kind, seed_.value}.add(moment_.generation).add(moment_.generation_tick).finish();
    std::uint32_t index = 0;
    for (const IslandSummary& island : islands_->summaries()) {
        hash_ += base::EntityHash{island_kind, index++}.add(island.hash.low).add(island.hash.high).finish();
    }
    if (!ratings_.empty()) {
        hash_ += hash_of(ratings_);
    }
}

} // namespace evod::simulation
