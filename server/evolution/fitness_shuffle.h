// Fitness shuffle: a control for experiments. The fitness of an island's organisms is dealt out among them anew, so
// that the selection has as much to tell apart as before, but nothing of it has to do with what anyone did or is.
//
// Owner        World, between a generation's end and the migration; whoever works out again how one was bred.
// Threads      none of its own.
// Determinism  keyed by (seed, FitnessShuffle, island, generation), so any island's can be dealt out again alone.
// Source       the permutation of a permutation test: Good 2005, "Permutation, Parametric and Bootstrap Tests of
//              Hypotheses".
#pragma once

#include "server/base/executor.h"
#include "server/evolution/next_generation.h"

#include <span>

namespace evod::evolution {

/// Every order of the values equally likely. generation: that has just ended.
void shuffle_fitness(std::span<double> fitness, const BreedingKey& key, base::Executor& executor);

} // namespace evod::evolution
