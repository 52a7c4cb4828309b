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

/// The fitness by which a generation is bred: shuffled on every island where the parameters ask for it, otherwise as it is.
/// Migration and selection both go by it, so whatever follows a run must apply this first.
///
/// fitness_of  fitness_of(i) returns island i's fitness, a std::span<double>, shape (population).
/// generation  that has just ended.
template <class FitnessOf>
void apply_shuffle(const Parameters& parameters, std::size_t island_count, FitnessOf&& fitness_of, base::Seed seed,
                   std::uint64_t generation, base::Executor& executor);

/// Every order of the values equally likely. generation: that has just ended.
void shuffle_fitness(std::span<double> fitness, const BreedingKey& key, base::Executor& executor);

template <class FitnessOf>
void apply_shuffle(const Parameters& parameters, std::size_t island_count, FitnessOf&& fitness_of, base::Seed seed,
                   std::uint64_t generation, base::Executor& executor) {
    for (std::uint32_t island = 0; parameters.shuffle_fitness && island < island_count; ++island) {
        shuffle_fitness(fitness_of(island), {.seed = seed, .island = island, .generation = generation}, executor);
    }
}

} // namespace evod::evolution
