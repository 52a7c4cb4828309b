// Scaling: converts fitness into the weights of proportional selection.
//
// Scaling never changes the order of organisms. Tournament and truncation selection need only the order, so they use
// the unscaled fitness.
// Determinism  weights are computed one by one, in order of index or rank.
#pragma once

#include "server/evolution/ga_parameters.h"
#include "server/evolution/ranking.h"

#include <cstdint>
#include <vector>

namespace evod::evolution {

/// Returns the expected number of copies of the organism of rank `rank` (0 = fittest) when `population` organisms are
/// drawn from `population`: pressure − 2(pressure − 1) · rank/(population − 1). It is 1 in a population of one.
///
/// pressure  1 (all equal) to 2 (the worst is never drawn).
/// Source    Baker 1985, "Adaptive selection methods for genetic algorithms".
double linear_rank_weight(std::uint32_t rank, std::uint32_t population, double pressure);

/// Returns the scaled fitness of each organism, depending on the parameter fitness_scaling.
///
/// none                 the fitness, unchanged.
/// windowing            the fitness minus the least fitness, so the worst gets 0; halved if that would overflow.
/// linear_ranking       linear_rank_weight with ranking_pressure.
/// exponential_ranking  ranking_decay^rank; 0 for ranks where this is below 2^-1022. Source: Blickle & Thiele 1996,
///                      Evol. Comput. 4(4), doi:10.1162/evco.1996.4.4.361.
std::vector<double> scaled_fitness(Ranking& ranking, const Parameters& parameters);

} // namespace evod::evolution
