// Ranking: the organisms of a population in order of fitness, sorted when first asked for.
//
// Determinism  a total order: of two equally fit organisms the one with the lower index has the better rank. −0 and 0
//              are equal.
// Source       least-significant-digit radix sort: Knuth, The Art of Computer Programming 3, 5.2.5.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace evod::evolution {

class Ranking {
  public:
    /// fitness  shape (population), finite; it must outlive the ranking.
    Ranking(std::span<const double> fitness) : fitness_{fitness} {} // NOLINT(google-explicit-constructor)

    /// Shape (population): the index of the organism of each rank, rank 0 the fittest. Not for several threads at once.
    std::span<const std::uint32_t> best_first();

    std::span<const double> fitness() const { return fitness_; }

  private:
    std::span<const double> fitness_;
    std::vector<std::uint32_t> best_first_;
};

} // namespace evod::evolution
