#include "server/evolution/fitness_shuffle.h"

#include "server/evolution/shuffle.h"

#include <cstdint>
#include <numeric>
#include <vector>

namespace evod::evolution {

void shuffle_fitness(std::span<double> fitness, const BreedingKey& key, base::Executor& executor) {
    std::vector<std::uint32_t> whose(fitness.size());
    std::iota(whose.begin(), whose.end(), 0u);
    base::RandomStream random{{key.seed, base::Purpose::FitnessShuffle, key.island, key.generation}, 0};
    shuffle(whose, random, executor);
    const std::vector<double> own(fitness.begin(), fitness.end());
    for (std::size_t organism = 0; organism < own.size(); ++organism) {
        fitness[organism] = own[whose[organism]];
    }
}

} // namespace evod::evolution
