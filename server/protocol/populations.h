// Populations: converts the population of a first generation to a message and back.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/simulation/first_population.h"

#include <vector>

namespace evod::protocol {

/// gene_count  number of genes of an organism in the world.
///
/// Returns nullptr if the request has no population. Also returns nullptr, and adds a violation, if the genes of an
/// island are not a whole number of chromosomes.
simulation::FirstPopulation first_population_of(const v1::CreateWorld& request, unsigned gene_count,
                                                std::vector<base::Violation>& violations);

void add_population(v1::CreateWorld& request, const simulation::FirstPopulation& population);

} // namespace evod::protocol
