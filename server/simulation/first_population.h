// First population: chromosomes that a run begins with instead of drawn ones.
#pragma once

#include "server/base/result.h"
#include "server/evolution/chromosome.h"
#include "server/parameters/parameters.h"

#include <memory>
#include <string>
#include <vector>

namespace evod::simulation {

/// One matrix per island; nullptr: they are drawn by the seed. Shared, for it is never changed and may be large.
using FirstPopulation = std::shared_ptr<const std::vector<evolution::GeneMatrix>>;

/// Whether two are the same, to the last bit but the sign of 0.
bool same(const FirstPopulation& a, const FirstPopulation& b);

/// What keeps a world with these parameters from beginning so: islands, organisms and genes that it cannot have.
///
/// field  of the population as the sender spells it: "create_world.population"; a gene is
///        "create_world.population[0].organism[17].body_size".
/// returns  empty if nothing does; at most faults_max of all that are wrong.
std::vector<base::Violation> faults_of(const FirstPopulation& population, const parameters::Parameters& parameters,
                                       const std::string& field);
constexpr std::size_t faults_max = 20;

} // namespace evod::simulation
