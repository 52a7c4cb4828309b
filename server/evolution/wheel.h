// The wheel: every organism has a slot as wide as its weight. Roulette spins the wheel once per pick; universal
// sampling spins it once for all picks.
//
// Determinism  widths are added in index order.
// Cost         O(population) to build; a pick takes two comparisons on average, for any weights.
// Source       Chen & Asau 1974, "On generating random variates from an empirical distribution" (the guide table).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace evod::evolution {

class Wheel {
  public:
    /// weights  shape (population), finite, population >= 1. If any weight is negative, the least weight is subtracted
    ///          from all. If all weights are then 0, all organisms get the same weight. Only the ratios of weights
    ///          matter, and their sum cannot overflow.
    explicit Wheel(std::vector<double> weights);

    /// Returns the organism at the position `turns`, in [0, 1) of a full turn: the first organism whose slot ends
    /// beyond that position. A slot of width 0 is never hit.
    std::uint32_t at(double turns) const;

    /// Returns the position where each organism's slot ends, in index order. The last element is the circumference.
    std::span<const double> slot_ends() const { return ends_; }

    /// Returns the organism's share of the circumference: the probability that a spin picks the organism.
    double share(std::uint32_t organism) const;

  private:
    std::vector<double> ends_;
    std::vector<std::uint32_t> guide_; // element i: the organism at i/population of a turn
};

} // namespace evod::evolution
