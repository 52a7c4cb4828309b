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
    /// fitness  shape (population), finite. It must outlive the ranking, and so must `executor`.
    Ranking(std::span<const double> fitness, base::Executor& executor) : fitness_{fitness}, executor_{&executor} {}
    /// Sorts on the calling thread.
    Ranking(std::span<const double> fitness) : fitness_{fitness} {} // NOLINT(google-explicit-constructor)

    /// Shape (population): the index of the organism of each rank, rank 0 the fittest. Not to be called by several
    /// threads at once.
    std::span<const std::uint32_t> best_first();

    std::span<const double> fitness() const { return fitness_; }

  private:
    std::span<const double> fitness_;
    base::Executor* executor_ = nullptr;
    std::vector<std::uint32_t> best_first_;
};

} // namespace evod::evolution
