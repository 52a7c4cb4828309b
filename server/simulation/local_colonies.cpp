// The turn of a generation on local islands of colonies: of two species that are bred, or of an interval with births.
#include "server/simulation/local_islands.h"

#include <optional>
#include <utility>

namespace evod::simulation {
namespace {

constexpr std::array<Species, 2> both_species = {Species::Prey, Species::Predator};

template <class T>
std::vector<T> selected(std::span<const T> from, std::span<const std::uint32_t> ids) {
    std::vector<T> result;
    for (const std::uint32_t id : ids) {
        result.push_back(from[id]);
    }
    return result;
}

evolution::GeneMatrix selected(const evolution::GeneMatrix& from, std::span<const std::uint32_t> ids) {
    evolution::GeneMatrix result(from.rows(), std::ssize(ids));
    for (std::size_t i = 0; i < ids.size(); ++i) {
        result.col(static_cast<Eigen::Index>(i)) = from.col(ids[i]);
    }
    return result;
}

/// Appends the next generation of predators to that of the prey.
///
/// ids  of their parents in the whole previous generation.
void append(evolution::NextGeneration& to, const evolution::NextGeneration& predators) {
    const Eigen::Index prey = to.genes.cols();
    to.genes.conservativeResize(Eigen::NoChange, prey + predators.genes.cols());
    to.genes.rightCols(predators.genes.cols()) = predators.genes;
    to.parents.insert(to.parents.end(), predators.parents.begin(), predators.parents.end());
    to.clamped_count += predators.clamped_count;
    to.predator_count = static_cast<std::uint32_t>(predators.genes.cols());
    to.predator_account = predators.account;
}

std::uint32_t founder_of(std::span<const std::uint32_t> founders, const evolution::Parents& parents) {
    return parents.first == Island::no_parents.first ? no_founder : founders[parents.first];
}

/// Puts a migrant in the place of an organism: a newcomer at rest, with a number of its own.
///
/// account  of the species, which has `count` organisms.
void replace(Island::Continuation& island, std::uint32_t id, const Eigen::Ref<const Eigen::ArrayXf>& genes,
             std::optional<evolution::SelectionAccount>& account, double count) {
    for (std::size_t gene = 0; account && gene < account->size(); ++gene) {
        const auto row = static_cast<Eigen::Index>(gene);
        const double change =
            (static_cast<double>(genes(row)) - static_cast<double>(island.bred.genes(row, id))) / count;
        (*account)[gene].migration += change;
        (*account)[gene].change += change;
    }
    island.bred.genes.col(id) = genes;
    island.bred.parents[id] = Island::no_parents;
    island.opening.numbers[id] = island.opening.next_number++;
    island.opening.age_ticks[id] = 0;
    IslandState& state = island.opening.state;
    state.life_records.children[id] = 0;
    state.hunts_from[id] = 0;
    state.organisms[id].velocity_x = state.organisms[id].velocity_y = 0;
    state.organisms[id].health = genes(evolution::BaseHealth);
}

} // namespace

BredIslands LocalIslands::bred_with_predators(const parameters::Parameters& parameters, std::uint64_t generation,
                                              const Routes& routes, base::Executor& executor, const Carry& carry) {
    BredIslands bred;
    bred.islands.resize(islands_.size());
    bred.founders.resize(founders_.empty() ? 0 : islands_.size());
    for (const Species species : both_species) {
        const bool is_predator = species == Species::Predator;
        const parameters::Parameters own = is_predator ? parameters::of_predators(parameters) : parameters;
        std::vector<std::vector<std::uint32_t>> ids;
        Breeders breeders;
        for (std::size_t i = 0; i < islands_.size(); ++i) {
            ids.push_back(islands_[i].breeders(species));
            breeders.genes.push_back(selected(breeding_genes(i), ids[i]));
            breeders.fitness.push_back(selected(std::span<const double>{fitness_[i]}, ids[i]));
            if (!founders_.empty()) {
                breeders.founders.push_back(selected(std::span<const std::uint32_t>{founders_[i]}, ids[i]));
            }
        }
        const std::vector<evolution::GeneMatrix> born = breeders.genes;
        const auto& own_routes = is_predator ? routes.predators : routes.prey;
        if (!own_routes.empty()) {
            (void)migrate(breeders, own, migration_key(generation, species), own_routes, carry);
        }
        for (std::size_t i = 0; i < islands_.size(); ++i) {
            evolution::NextGeneration next;
            if (is_predator && generation + 1 == parameters.predator_from) {
                next.genes = evolution::initial_population(own.population_size, own, seed_,
                                                           key_of(i, species, generation).island);
                next.parents.assign(own.population_size, Island::no_parents);
            } else if (!ids[i].empty()) {
                next = evolution::next_generation(breeders.fitness[i], breeders.genes[i], own, own.population_size,
                                                  key_of(i, species, generation), executor);
                next.account = evolution::account_for(born[i], breeders.genes[i], next.genes, next.parents, executor);
            }
            for (std::size_t k = 0; k < next.parents.size(); ++k) {
                evolution::Parents& parents = next.parents[k];
                if (!founders_.empty()) {
                    bred.founders[i].push_back(founder_of(breeders.founders[i], parents));
                }
                if (parents.first != Island::no_parents.first) {
                    parents = {ids[i][parents.first], ids[i][parents.second]};
                }
            }
            if (!is_predator) {
                bred.islands[i] = std::move(next);
            } else if (next.genes.cols() > 0) { // otherwise they have not yet arrived
                append(bred.islands[i], next);
            }
        }
    }
    return bred;
}

BredIslands LocalIslands::continued(const parameters::Parameters& parameters, std::uint64_t generation,
                                    std::uint32_t tick, const Routes& routes, base::Executor& executor,
                                    const Carry& carry) {
    std::vector<Island::Continuation> next(islands_.size());
    for_each_island(executor, [&](std::size_t i) {
        next[i] = islands_[i].continuation(parameters, tick, executor);
        if (parameters.predator_count > 0 && generation + 1 == parameters.predator_from) {
            islands_[i].add_predators(next[i], parameters, generation + 1);
        }
    });
    BredIslands bred;
    for (std::size_t i = 0; i < founders_.size(); ++i) {
        std::vector<std::uint32_t>& founders = bred.founders.emplace_back();
        for (const evolution::Parents& parents : next[i].bred.parents) {
            founders.push_back(founder_of(founders_[i], parents));
        }
    }
    for (const Species species : both_species) {
        const auto& own_routes = species == Species::Predator ? routes.predators : routes.prey;
        if (own_routes.empty()) {
            continue;
        }
        Breeders breeders;
        std::vector<std::vector<std::uint32_t>> ids(islands_.size());
        for (std::size_t i = 0; i < islands_.size(); ++i) {
            const std::uint32_t count = islands_[i].breeder_count(species);
            const std::uint32_t first = species == Species::Prey ? 0 : islands_[i].breeder_count(Species::Prey);
            for (std::uint32_t id = first; id < first + count; ++id) {
                ids[i].push_back(id);
            }
            breeders.genes.push_back(selected(next[i].bred.genes, ids[i]));
            std::vector<double>& fitness = breeders.fitness.emplace_back();
            for (const std::uint32_t id : ids[i]) {
                fitness.push_back(next[i].opening.state.life_records.children[id]);
            }
            if (!bred.founders.empty()) {
                breeders.founders.push_back(selected(std::span<const std::uint32_t>{bred.founders[i]}, ids[i]));
            }
        }
        const auto replaced = migrate(breeders, parameters, migration_key(generation, species), own_routes, carry);
        for (std::size_t i = 0; i < islands_.size(); ++i) {
            Island::Continuation& island = next[i];
            auto& account = species == Species::Prey ? island.bred.account : island.bred.predator_account;
            for (const std::uint32_t place : replaced[i]) {
                const std::uint32_t id = ids[i][place];
                replace(island, id, breeders.genes[i].col(place), account, static_cast<double>(ids[i].size()));
                if (!bred.founders.empty()) {
                    bred.founders[i][id] = breeders.founders[i][place];
                }
            }
        }
    }
    for (Island::Continuation& island : next) {
        bred.islands.push_back(std::move(island.bred));
        bred.openings.push_back(std::move(island.opening));
    }
    return bred;
}

} // namespace evod::simulation
