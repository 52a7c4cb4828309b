// Ranking: the organisms of a population in order of fitness, sorted on first use.
//
// Determinism  a total order: of two equally fit organisms the one with the lower index has the better rank. −0 and 0
//              are equal.
// Cost         O(n) if the fitness is distributed about evenly over its range, never more than O(n log n).
// Source       bucket sort: Knuth, The Art of Computer Programming 3, 5.2.1.
#pragma once

#include "server/base/executor.h"

#include <cstdint>
#include <span>
#include <vector>

namespace evod::evolution {

class Ranking {
  public:
    /// fitness  the fitness of each organism, finite. The ranking refers to `fitness` and `executor`, which must
    ///          outlive it.
    Ranking(std::span<const double> fitness, base::Executor& executor) : fitness_{fitness}, executor_{&executor} {}
    /// Creates a ranking that sorts on the calling thread.
    Ranking(std::span<const double> fitness) : fitness_{fitness} {} // NOLINT(google-explicit-constructor)

    /// Returns the indices of all organisms, the fittest first. Only one thread at a time may call this function.
    std::span<const std::uint32_t> best_first();

    std::span<const double> fitness() const { return fitness_; }
    /// Returns the fitness of the best `count` organisms, the fittest first. As best_first().
    std::vector<double> best_fitness(std::uint32_t count);

  private:
    std::span<const double> fitness_;
    base::Executor* executor_ = nullptr;
    std::vector<std::uint32_t> best_first_;
};

} // namespace evod::evolution
