// Converts first populations to messages and back.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/simulation/first_population.h"

#include <vector>

namespace evod::protocol {

/// nullptr if the request has none, or if the numbers of an island are not a whole number of chromosomes; the latter is
/// added to `violations`.
simulation::FirstPopulation first_population_of(const v1::CreateWorld& request,
                                                std::vector<base::Violation>& violations);

void add_population(v1::CreateWorld& request, const simulation::FirstPopulation& population);

} // namespace evod::protocol
