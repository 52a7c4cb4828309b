// Selection law: how often a selection method picks each organism on average.
//
// Source       Blickle & Thiele 1996, Evol. Comput. 4(4), doi:10.1162/evco.1996.4.4.361; for tournaments with several
//              winners, the mean of a binomial or hypergeometric number that is limited to the number of winners.
#pragma once

#include "server/evolution/parameters.h"
#include "server/evolution/selection.h"

#include <cstdint>

namespace evod::evolution {

struct Tournament;

class SelectionLaw {
  public:
    /// population  organisms to pick from, >= 1.
    /// picks       as passed to select().
    SelectionLaw(std::uint32_t population, const Picks& picks, const Parameters& parameters)
        : population_{population}, picks_{picks}, parameters_{parameters} {}

    /// The expected number of picks, of all the picks, that go to one organism.
    ///
    /// rank   0 is the fittest.
    /// share  of the wheel; ignored by methods without a wheel.
    double expected_copies(std::uint32_t rank, double share) const;

  private:
    double expected_wins(std::uint32_t rank) const;

    std::uint32_t population_;
    Picks picks_;
    Parameters parameters_;
};

/// The mean number of winners of one tournament whose rank is at most `rank`: the contestants with such a rank, but not
/// more than the number of winners.
///
/// tournament  size, without replacement at most the population; winners at most its size.
/// cost        grows with the square root of the size.
double expected_winners_up_to(std::uint32_t rank, std::uint32_t population, const Tournament& tournament);

} // namespace evod::evolution
