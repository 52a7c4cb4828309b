// Populations: converts the population of a first generation to a message and back.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/simulation/first_population.h"

#include <vector>

namespace evod::protocol {

/// parameters  of the world.
///
/// Returns nullptr if the request has no population. Also returns nullptr, and adds a violation, if the population has
/// other genes than the world, or if the genes of an island are not a whole number of chromosomes.
simulation::FirstPopulation first_population_of(const v1::CreateWorld& request,
                                                const parameters::Parameters& parameters,
                                                std::vector<base::Violation>& violations);

void add_population(v1::CreateWorld& request, const simulation::FirstPopulation& population);

} // namespace evod::protocol
