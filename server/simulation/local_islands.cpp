#include "server/simulation/local_islands.h"

#include "server/base/assert.h"
#include "server/evolution/fitness_shuffle.h"
#include "server/evolution/objectives.h"

#include <numeric>
#include <utility>

namespace evod::simulation {

std::vector<double> IslandOutcome::deciding_fitness() const {
    return objectives.empty() ? fitness : evolution::standing({objectives, objectives.size() / fitness.size()});
}

std::unique_ptr<Islands> make_islands(base::Seed seed, std::uint32_t island_count, IslandsMaker* maker) {
    if (maker != nullptr && maker->divides(island_count)) {
        return maker->make(seed, island_count);
    }
    return std::make_unique<LocalIslands>(seed, base::Range{0, island_count});
}

namespace {

/// Adds the predators of the first generation.
void draw_predators(evolution::NextGeneration& to, const parameters::Parameters& parameters, base::Seed seed,
                    std::uint32_t island) {
    const parameters::Parameters of_predators = parameters::of_predators(parameters);
    const evolution::GeneMatrix genes =
        evolution::initial_population(of_predators.population_size, of_predators, seed, island | 1u << 31);
    to.genes.conservativeResize(Eigen::NoChange, to.genes.cols() + genes.cols());
    to.genes.rightCols(genes.cols()) = genes;
    to.predator_count = of_predators.population_size;
}

} // namespace

LocalIslands::LocalIslands(base::Seed seed, base::Range indices) : seed_{seed}, first_{indices.begin} {
    for (std::size_t index = indices.begin; index < indices.end; ++index) {
        islands_.emplace_back(seed, static_cast<std::uint32_t>(index));
    }
    summaries_.resize(islands_.size());
}

void LocalIslands::summarise(bool at_first_moment) {
    for (std::size_t i = 0; i < islands_.size(); ++i) {
        const Island& island = islands_[i];
        summaries_[i] = {
            .hash = island.hash(),
            .alive_count = island.alive_count(),
            .organism_count = static_cast<std::uint32_t>(island.born().genes.cols()),
            .breeder_counts = {island.breeder_count(Species::Prey), island.breeder_count(Species::Predator)},
            .is_as_begun = at_first_moment && island.is_as_begun()};
    }
}

void LocalIslands::begin_generation(const parameters::Parameters& parameters, std::uint64_t generation,
                                    BredIslands bred, base::Executor& executor) {
    const bool is_drawn = bred.islands.empty();
    EVOD_ASSERT(is_drawn || bred.islands.size() == islands_.size());
    fitness_.clear();
    objectives_.clear();
    repaired_.clear();
    bred.islands.resize(islands_.size());
    for_each_island(executor, [&](std::size_t i) {
        if (is_drawn) {
            bred.islands[i].genes =
                evolution::initial_population(parameters.population_size, parameters, seed_, islands_[i].index());
        }
        if (generation == 1 && parameters.predator_from == 1 && bred.islands[i].predator_count == 0) {
            draw_predators(bred.islands[i], parameters, seed_, islands_[i].index());
        }
        islands_[i].begin_generation(parameters, generation, std::move(bred.islands[i]), executor,
                                     bred.openings.empty() ? std::nullopt : std::optional{std::move(bred.openings[i])});
    });
    founders_ = std::move(bred.founders);
    if (generation == 1) {
        founders_.resize(islands_.size());
        for (std::size_t i = 0; i < islands_.size(); ++i) { // all islands begin with the same number of organisms
            const auto count = static_cast<std::size_t>(islands_[i].born().genes.cols());
            founders_[i].resize(count);
            std::iota(founders_[i].begin(), founders_[i].end(), static_cast<std::uint32_t>((first_ + i) * count));
        }
    }
    EVOD_ASSERT(founders_.empty() || founders_.size() == islands_.size());
    summarise(true);
}

void LocalIslands::restore(const parameters::Parameters& begun_with, const WorldState& state,
                           base::Executor& executor) {
    const auto tick = static_cast<std::uint32_t>(state.moment.generation_tick);
    for_each_island(executor,
                    [&](std::size_t i) { islands_[i].restore(state.islands[i], tick, begun_with, executor); });
    find_founders();
    if (!state.ratings.empty()) {
        use(state.ratings, state.parameters.active);
    } else if (!state.ended.empty()) {
        find_fitness(state.parameters.active, tick, executor);
    }
    summarise(tick == 0);
}

Advanced LocalIslands::advance(const parameters::Parameters& parameters, GenerationTicks ticks,
                               base::Executor& executor, std::vector<DiedOut>& died_out) {
    for (std::uint32_t tick = ticks.first;; ++tick) {
        died_out_.assign(islands_.size(), 0);
        for_each_island(executor, [&](std::size_t i) {
            if (islands_[i].alive_count() == 0) {
                islands_[i].skip_tick(tick);
                return;
            }
            islands_[i].advance_tick(parameters, tick, executor);
            died_out_[i] = islands_[i].alive_count() == 0;
        });
        std::uint64_t alive_count = 0;
        for (std::size_t i = 0; i < islands_.size(); ++i) {
            summaries_[i].hash = islands_[i].hash();
            summaries_[i].alive_count = islands_[i].alive_count();
            summaries_[i].organism_count = static_cast<std::uint32_t>(islands_[i].born().genes.cols());
            summaries_[i].breeder_counts = {islands_[i].breeder_count(Species::Prey),
                                            islands_[i].breeder_count(Species::Predator)};
            summaries_[i].is_as_begun = false;
            alive_count += islands_[i].alive_count();
            if (died_out_[i]) {
                died_out.push_back({islands_[i].index(), tick});
            }
        }
        if (alive_count == 0 || tick == ticks.last) {
            find_founders();
            return {tick, alive_count};
        }
    }
}

void LocalIslands::find_fitness(const parameters::Parameters& parameters, std::uint32_t tick,
                                base::Executor& executor) {
    fitness_.clear();
    for (const Island& island : islands_) {
        fitness_.push_back(island.fitness(parameters, tick, executor));
    }
}

void LocalIslands::use(std::span<const Rating> given, const parameters::Parameters& parameters) {
    const std::size_t count = parameters.objectives;
    fitness_.clear();
    objectives_.assign(given.size(), {});
    repaired_.assign(given.size(), {});
    for (std::size_t i = 0; i < given.size(); ++i) {
        std::vector<double>& fitness = fitness_.emplace_back();
        for (std::size_t first = 0; first < given[i].fitness.size(); first += count) {
            fitness.push_back(given[i].fitness[first]);
        }
        if (count > 1) {
            objectives_[i] = given[i].fitness;
        }
        if (!given[i].genes.empty()) {
            const Eigen::Index rows = islands_[i].born().genes.rows();
            repaired_[i] =
                Eigen::Map<const evolution::GeneMatrix>{given[i].genes.data(), rows, std::ssize(given[i].genes) / rows};
        }
    }
}

const evolution::GeneMatrix& LocalIslands::breeding_genes(std::size_t i) const {
    return repaired_.empty() || repaired_[i].size() == 0 ? islands_[i].born().genes : repaired_[i];
}

std::vector<GenerationStatistics> LocalIslands::end_generation(const parameters::Parameters& parameters,
                                                               std::uint32_t tick, std::span<const Rating> given,
                                                               base::Executor& executor) {
    if (given.empty()) {
        find_fitness(parameters, tick, executor);
    } else {
        use(given, parameters);
    }
    std::vector<GenerationStatistics> statistics;
    for (std::size_t i = 0; i < islands_.size(); ++i) {
        statistics.push_back(generation_statistics(islands_[i], parameters, fitness_[i], tick, executor));
    }
    return statistics;
}

void LocalIslands::breed_next_generation(const parameters::Parameters& parameters, std::uint64_t generation,
                                         std::uint32_t tick, const Routes& routes, base::Executor& executor,
                                         const Carry& carry) {
    for (std::size_t i = 0; i < islands_.size(); ++i) {
        if (!objectives_.empty() && !objectives_[i].empty()) {
            fitness_[i] = evolution::standing({objectives_[i], parameters.objectives});
        }
        if (parameters.shuffle_fitness) {
            evolution::shuffle_fitness(fitness_[i], key_of(i, Species::Prey, generation), executor);
        }
        islands_[i].free_weights();
    }
    if (is_colony(parameters)) {
        begin_generation(parameters, generation + 1,
                         parameters::has_births(parameters)
                             ? continued(parameters, generation, tick, routes, executor, carry)
                             : bred_with_predators(parameters, generation, routes, executor, carry),
                         executor);
        return;
    }
    Breeders migrated;
    if (!routes.empty()) {
        for (std::size_t i = 0; i < islands_.size(); ++i) {
            migrated.genes.push_back(breeding_genes(i));
        }
        migrated.fitness = std::move(fitness_);
        migrated.founders = std::move(founders_);
        (void)migrate(migrated, parameters, generation, routes.prey, carry);
        fitness_ = std::move(migrated.fitness);
        founders_ = std::move(migrated.founders);
    }
    BredIslands bred{.islands = std::vector<evolution::NextGeneration>(islands_.size()),
                     .founders = std::move(founders_)};
    for_each_island(executor, [&](std::size_t i) {
        const evolution::GeneMatrix& born = breeding_genes(i);
        const evolution::GeneMatrix& genes = routes.empty() ? born : migrated.genes[i];
        evolution::NextGeneration& next = bred.islands[i];
        next = evolution::next_generation(fitness_[i], genes, parameters, parameters.population_size,
                                          key_of(i, Species::Prey, generation), executor);
        next.account = evolution::account_for(born, genes, next.genes, next.parents, executor);
    });
    for (std::size_t i = 0; i < bred.founders.size(); ++i) {
        std::vector<std::uint32_t> founders;
        founders.reserve(bred.islands[i].parents.size());
        for (const evolution::Parents& parents : bred.islands[i].parents) {
            founders.push_back(bred.founders[i][parents.first]);
        }
        bred.founders[i] = std::move(founders);
    }
    begin_generation(parameters, generation + 1, std::move(bred), executor);
}

std::vector<std::vector<std::uint32_t>>
LocalIslands::migrate(Breeders& breeders, const parameters::Parameters& parameters, std::uint64_t key,
                      std::span<const evolution::MigrationRoute> routes, const Carry& carry) const {
    std::vector<evolution::Ranking> rankings(breeders.fitness.begin(), breeders.fitness.end());
    std::vector<Migrants> migrants(routes.size());
    for (std::size_t r = 0; r < routes.size(); ++r) {
        if (!holds(routes[r].from)) {
            continue;
        }
        const std::size_t from = routes[r].from - first_;
        const auto leaving = evolution::emigrants(routes[r], rankings[from], parameters, seed_, key);
        migrants[r].genes.resize(breeders.genes[from].rows(), std::ssize(leaving));
        for (const std::uint32_t organism : leaving) {
            migrants[r].genes.col(std::ssize(migrants[r].fitness)) = breeders.genes[from].col(organism);
            migrants[r].fitness.push_back(breeders.fitness[from][organism]);
            migrants[r].founders.push_back(breeders.founders.empty() ? no_founder : breeders.founders[from][organism]);
        }
    }
    carry(routes, migrants);
    std::vector<std::vector<std::uint32_t>> all_replaced(breeders.genes.size());
    std::vector<std::uint32_t> replaced;              // on the island `to` of the previous route
    for (std::size_t r = 0; r < routes.size(); ++r) { // ordered by (to, from)
        const evolution::MigrationRoute& route = routes[r];
        if (!holds(route.to)) {
            continue;
        }
        const std::size_t to = route.to - first_;
        if (r == 0 || routes[r - 1].to != route.to) {
            replaced = evolution::replaced_first(route.to, rankings[to], parameters, seed_, key);
        }
        for (std::uint32_t i = 0; i < route.count; ++i) {
            const std::uint32_t place = replaced[route.first_place + i];
            breeders.genes[to].col(place) = migrants[r].genes.col(i);
            breeders.fitness[to][place] = migrants[r].fitness[i];
            if (!breeders.founders.empty()) {
                breeders.founders[to][place] = migrants[r].founders[i];
            }
            all_replaced[to].push_back(place);
        }
    }
    return all_replaced;
}

void LocalIslands::find_founders() {
    for (std::size_t i = 0; i < founders_.size(); ++i) {
        const Island& island = islands_[i];
        while (founders_[i].size() < island.life_records().cause.size()) {
            const std::uint32_t parent = island.parents_of_child(static_cast<std::uint32_t>(founders_[i].size())).first;
            founders_[i].push_back(parent == Island::no_parents.first ? no_founder : founders_[i][parent]);
        }
    }
}

EntityIds LocalIslands::place(const PlaceEntities& command, const parameters::Parameters& parameters,
                              std::uint32_t tick) {
    Island& island = islands_[command.island - first_];
    EntityIds ids;
    for (const PlaceEntities::Item& item : command.items) {
        (item.kind == ItemKind::Food ? ids.food : ids.poison)
            .push_back(island.place(item.kind, {physics::to_units(item.x_px), physics::to_units(item.y_px)}));
    }
    std::vector<Island::NewOrganism> organisms;
    for (const PlaceEntities::Organism& organism : command.organisms) {
        organisms.push_back(
            {{physics::to_units(organism.x_px), physics::to_units(organism.y_px)}, organism.genes, tick});
    }
    if (!organisms.empty()) {
        ids.organisms.resize(organisms.size());
        std::iota(ids.organisms.begin(), ids.organisms.end(), island.place(organisms, parameters));
        find_founders();
    }
    summarise(tick == 0);
    return ids;
}

void LocalIslands::remove(const RemoveEntities& command, std::uint32_t tick) {
    Island& island = islands_[command.island - first_];
    for (const std::uint32_t item : command.food) {
        island.remove(ItemKind::Food, item);
    }
    for (const std::uint32_t item : command.poison) {
        island.remove(ItemKind::Poison, item);
    }
    for (const std::uint32_t organism : command.organisms) {
        island.remove_organism(organism, tick);
    }
    summarise(tick == 0);
}

BredIslands LocalIslands::bred() const {
    BredIslands bred{.islands = {}, .founders = founders_};
    for (const Island& island : islands_) {
        bred.islands.push_back(island.bred());
    }
    for (std::size_t i = 0; i < founders_.size(); ++i) {
        bred.founders[i].resize(islands_[i].bred_count());
    }
    if (islands_.front().opening() != nullptr) {
        for (const Island& island : islands_) {
            bred.openings.push_back(*island.opening());
        }
    }
    return bred;
}

std::vector<IslandOutcome> LocalIslands::outcomes() const {
    std::vector<IslandOutcome> outcomes;
    for (std::size_t i = 0; i < islands_.size(); ++i) {
        const LifeRecords& life_records = islands_[i].life_records();
        outcomes.push_back(
            {.fitness = fitness_[i], .lived_ticks = life_records.lived_ticks, .cause = life_records.cause});
        if (islands_[i].has_births()) {
            for (std::uint32_t id = islands_[i].bred_count(); id < life_records.cause.size(); ++id) {
                outcomes.back().births.push_back({islands_[i].placed_tick(id), islands_[i].parents_of_child(id)});
            }
        }
        if (!objectives_.empty()) {
            outcomes.back().objectives = objectives_[i];
            outcomes.back().repaired.assign(repaired_[i].data(), repaired_[i].data() + repaired_[i].size());
        }
    }
    return outcomes;
}

std::vector<IslandState> LocalIslands::states(base::Executor& executor) const {
    std::vector<IslandState> states(islands_.size());
    for_each_island(executor, [&](std::size_t i) { states[i] = islands_[i].state(executor); });
    return states;
}

} // namespace evod::simulation
