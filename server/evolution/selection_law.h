// Selection law: how often a selection method picks each organism on average, and how much this number varies between
// breedings.
//
// Owner        BreedingRecord; nothing in a running world uses it.
// Threads      none of its own.
// Determinism  reads no random stream.
// Source       Blickle & Thiele 1996, Evol. Comput. 4(4), doi:10.1162/evco.1996.4.4.361; Baker 1987, "Reducing bias and
//              inefficiency in the selection algorithm". For tournaments with several winners, the number of wins is a
//              binomial or hypergeometric number of contestants, limited to the number of winners.
#pragma once

#include "server/evolution/ga_parameters.h"
#include "server/evolution/selection.h"

#include <cstdint>

namespace evod::evolution {

struct Tournament;

/// The distribution of the number of copies of one organism, over all picks of one breeding.
struct CopiesLaw {
    double expected = 0;
    double standard_error = 0;  // standard deviation of the copies from one breeding to the next
    double unpicked_chance = 1; // probability that the organism is not picked at all
};

class SelectionLaw {
  public:
    /// Creates the law of one selection.
    ///
    /// population  the number of organisms to pick from, >= 1.
    /// picks       the picks that select() receives.
    SelectionLaw(std::uint32_t population, const Picks& picks, const Parameters& parameters)
        : population_{population}, picks_{picks}, parameters_{parameters} {}

    /// Returns the distribution of the number of copies of one organism.
    ///
    /// rank   the rank of the organism; 0 is the fittest.
    /// share  the organism's share of the wheel, for roulette and universal sampling; the other methods ignore it.
    CopiesLaw copies(std::uint32_t rank, double share) const;

  private:
    CopiesLaw tournament_copies(std::uint32_t rank) const;

    std::uint32_t population_;
    Picks picks_;
    Parameters parameters_;
};

/// The distribution of the number of wins of one rank in one tournament.
struct WinsLaw {
    double mean = 0;
    double mean_square = 0;
    double none_chance = 1; // probability of no win
};

/// Computes how often the organism of rank `rank` wins one tournament. The time grows with the square root of
/// tournament.size; with replacement and several winners, at most linearly.
///
/// tournament  must have winners <= size and, without replacement, size <= population.
WinsLaw wins_of_rank(std::uint32_t rank, std::uint32_t population, const Tournament& tournament);

} // namespace evod::evolution
