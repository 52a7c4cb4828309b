// Bets: the organisms that the user expects to be picked in a breeding, and the score of these bets.
//
// Owner        BreedingPanel.
// Threads      none.
#pragma once

#include "client/viewer/panels/breeding/comparison.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace evod::viewer {

class Bets {
  public:
    static constexpr std::size_t bets_max = 5;

    /// Places a bet on the organism, or withdraws it. Ignores further bets after bets_max.
    void toggle(std::uint32_t organism);
    bool has(std::uint32_t organism) const { return std::ranges::count(organisms_, organism) > 0; }
    bool full() const { return organisms_.size() == bets_max; }
    void clear() { organisms_.clear(); }
    /// Returns the organisms in the order of the bets.
    const std::vector<std::uint32_t>& organisms() const { return organisms_; }

  private:
    std::vector<std::uint32_t> organisms_;
};

/// The result of bets after some picks. One pick of an organism with a bet is one hit.
struct BetScore {
    std::size_t bets = 0;
    std::uint32_t picks = 0, hits = 0;
    double random = 0;      // expected hits of as many bets on organisms drawn at random, for the picks that were made
    double law = 0;         // expected hits of these bets by the law of the selection method, for all picks
    std::uint32_t most = 0; // most hits that this number of bets could have had
};

/// Computes the score of the bets.
///
/// copies  copies of each rank in the first `picks` picks, shape (ranks)
BetScore score_of(const Bets& bets, const Comparison& comparison, std::span<const std::uint32_t> copies,
                  std::uint32_t picks);

/// Returns the score as sentences: "4 of 25 picks hit your 5 bets, 1.6 times as many as random bets (expected 2.5). …".
///
/// complete  whether all picks were made; otherwise the text does not contain the law and the best possible bets
std::string score_text(const BetScore& score, bool complete);

} // namespace evod::viewer
