// Fitness shuffle: a control for experiments. It permutes the fitness values of an island's organisms at random.
// Selection is then as strong as before, but unrelated to the organisms' genes.
//
// Owner        World, between a generation's end and the migration. Code that recomputes a breeding uses it too.
// Threads      none of its own.
// Determinism  keyed by (seed, FitnessShuffle, island, generation), so the shuffle of one island can be repeated alone.
// Source       the permutation of a permutation test: Good 2005, "Permutation, Parametric and Bootstrap Tests of
//              Hypotheses".
#pragma once

#include "server/base/executor.h"
#include "server/evolution/next_generation.h"

#include <span>

namespace evod::evolution {

/// Shuffles the fitness values of every island if shuffle_fitness is on; otherwise changes nothing. Migration and
/// selection both use the result, so code that recomputes a breeding must call this function first.
///
/// fitness_of  fitness_of(i) returns island i's fitness, a std::span<double>, shape (population).
/// generation  the generation that has just ended.
template <class FitnessOf>
void apply_shuffle(const Parameters& parameters, std::size_t island_count, FitnessOf&& fitness_of, base::Seed seed,
                   std::uint64_t generation, base::Executor& executor);

/// Permutes the fitness values; every order is equally likely. The generation of `key` is the one that has just ended.
void shuffle_fitness(std::span<double> fitness, const BreedingKey& key, base::Executor& executor);

template <class FitnessOf>
void apply_shuffle(const Parameters& parameters, std::size_t island_count, FitnessOf&& fitness_of, base::Seed seed,
                   std::uint64_t generation, base::Executor& executor) {
    for (std::uint32_t island = 0; parameters.shuffle_fitness && island < island_count; ++island) {
        shuffle_fitness(fitness_of(island), {.seed = seed, .island = island, .generation = generation}, executor);
    }
}

} // namespace evod::evolution
