// Ranking: the organisms of a population in order of fitness, sorted when first asked for.
//
// Determinism  a total order: of two equally fit organisms the one with the lower index has the better rank. −0 and 0
//              are equal.
// Cost         O(n) where the fitness is spread about evenly over its range, never more than O(n log n).
// Source       bucket sort: Knuth, The Art of Computer Programming 3, 5.2.1.
#pragma once

#include "server/base/executor.h"

#include <cstdint>
#include <span>
#include <vector>

namespace evod::evolution {

class Ranking {
  public:
    /// fitness  shape (population), finite; it must outlive the ranking, and so must `executor`.
    Ranking(std::span<const double> fitness, base::Executor& executor) : fitness_{fitness}, executor_{&executor} {}
    /// Sorts on the thread that asks.
    Ranking(std::span<const double> fitness) : fitness_{fitness} {} // NOLINT(google-explicit-constructor)

    /// Shape (population): the index of the organism of each rank, rank 0 the fittest. Not for several threads at once.
    std::span<const std::uint32_t> best_first();

    std::span<const double> fitness() const { return fitness_; }

  private:
    std::span<const double> fitness_;
    base::Executor* executor_ = nullptr;
    std::vector<std::uint32_t> best_first_;
};

} // namespace evod::evolution
