// Founders: fills the places of a first population that has fewer organisms than the world.
//
// Threads      any; no state.
// Determinism  the result depends only on the given organisms, the parameters and the seed.
#pragma once

#include "server/simulation/first_population.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace evod::simulation {

/// How the places are filled for which a population has no organism.
enum class Filling {
    FromSeed, // with the organisms that the world would have there without a population
    Clones,   // with copies of the island's organisms, in turn
};

/// Fills the islands of a population that has fewer organisms than the world has places; missing islands are drawn from
/// the seed. A population that is complete or too large is returned unchanged, so faults_of() must check the result.
inline FirstPopulation completed(const FirstPopulation& population, const parameters::Parameters& parameters,
                                 base::Seed seed, Filling filling = Filling::FromSeed) {
    const auto genes = static_cast<Eigen::Index>(evolution::gene_count(parameters));
    const auto places = static_cast<Eigen::Index>(parameters.population_size);
    const auto is_short = [&](const evolution::GeneMatrix& island) { return island.cols() < places; };
    if (!population || population->size() > parameters.island_count ||
        std::ranges::any_of(*population, [&](const auto& island) { return island.rows() != genes; }) ||
        (population->size() == parameters.island_count && std::ranges::none_of(*population, is_short))) {
        return population;
    }
    std::vector<evolution::GeneMatrix> islands = *population;
    islands.resize(parameters.island_count, evolution::GeneMatrix(genes, 0));
    for (std::uint32_t index = 0; index < parameters.island_count; ++index) {
        evolution::GeneMatrix& island = islands[index];
        const Eigen::Index given = island.cols();
        if (given >= places) {
            continue;
        }
        evolution::GeneMatrix filled =
            evolution::initial_population(parameters.population_size, parameters, seed, index);
        for (Eigen::Index organism = 0; organism < places; ++organism) {
            if (organism < given || (filling == Filling::Clones && given > 0)) {
                filled.col(organism) = island.col(organism % given);
            }
        }
        island = std::move(filled);
    }
    return std::make_shared<const std::vector<evolution::GeneMatrix>>(std::move(islands));
}

} // namespace evod::simulation
