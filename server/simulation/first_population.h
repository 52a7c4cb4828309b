// First population: chromosomes that a run begins with, instead of drawn ones.
#pragma once

#include "server/base/result.h"
#include "server/evolution/chromosome.h"
#include "server/parameters/parameters.h"

#include <memory>
#include <string>
#include <vector>

namespace evod::simulation {

/// One matrix per island; nullptr: drawn from the seed. Shared, because it is never changed and may be large.
using FirstPopulation = std::shared_ptr<const std::vector<evolution::GeneMatrix>>;

/// Whether two are equal to the last bit, except for the sign of 0.
bool same(const FirstPopulation& a, const FirstPopulation& b);

/// Why a world with these parameters cannot begin with this population: wrong numbers of islands or organisms, genes
/// out of bounds.
///
/// field    of the population as the sender spells it: "create_world.population"; a gene is
///          "create_world.population[0].organism[17].body_size".
/// returns  empty if it can; at most faults_max violations.
std::vector<base::Violation> faults_of(const FirstPopulation& population, const parameters::Parameters& parameters,
                                       const std::string& field);
constexpr std::size_t faults_max = 20;

} // namespace evod::simulation
