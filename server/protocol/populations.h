// Populations: what a world is given to begin with ⇄ messages.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/simulation/first_population.h"

#include <vector>

namespace evod::protocol {

/// nullptr where the request has none, or where the numbers of an island are no whole number of chromosomes, which is
/// then added to the violations.
simulation::FirstPopulation first_population_of(const v1::CreateWorld& request,
                                                std::vector<base::Violation>& violations);

void add_population(v1::CreateWorld& request, const simulation::FirstPopulation& population);

} // namespace evod::protocol
