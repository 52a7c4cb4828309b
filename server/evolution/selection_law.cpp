#include "server/evolution/selection_law.h"

#include "server/evolution/tournament.h"

#include <algorithm>
#include <cmath>

namespace evod::evolution {
namespace {

/// The mean of min(X, most), for X in [least, greatest]. Only the ratios of neighbouring probabilities are known.
///
/// mode   the most probable X; the probability falls on both sides of it.
/// ratio  ratio(x) = P(X = x + 1) / P(X = x).
template <class Ratio>
double mean_up_to(double most, double least, double mode, double greatest, const Ratio& ratio) {
    constexpr double negligible = 1e-22; // relative to the probability of the mode
    double all = 1, sum = std::min(mode, most);
    double chance = 1;
    for (double x = mode; x < greatest && chance > negligible; ++x) {
        chance *= ratio(x);
        all += chance;
        sum += chance * std::min(x + 1, most);
    }
    chance = 1;
    for (double x = mode; x > least && chance > negligible; --x) {
        chance /= ratio(x - 1);
        all += chance;
        sum += chance * std::min(x - 1, most);
    }
    return sum / all;
}

} // namespace

double expected_winners_up_to(std::uint32_t rank, std::uint32_t population, const Tournament& tournament) {
    const double size = tournament.size, winners = tournament.winners;
    const double good = rank + 1.0, others = population - good;
    if (others == 0) {
        return winners;
    }
    if (tournament.replacement) {
        const double mode = std::min(std::floor((size + 1) * (good / population)), size);
        return mean_up_to(winners, 0, mode, size, [&](double x) { return (size - x) / (x + 1) * (good / others); });
    }
    const double least = std::max(0.0, size - others), greatest = std::min(good, size);
    const double mode = std::clamp(std::floor((size + 1) * ((good + 1) / (population + 2.0))), least, greatest);
    return mean_up_to(winners, least, mode, greatest,
                      [&](double x) { return (good - x) / (x + 1) * ((size - x) / (others - size + x + 1)); });
}

double SelectionLaw::expected_wins(std::uint32_t rank) const {
    Tournament tournament = tournament_of(parameters_);
    if (!tournament.replacement) {
        tournament.size = std::min(tournament.size, population_);
    }
    const auto wins_of = [&](std::uint32_t winners) {
        tournament.winners = winners;
        const double better = rank == 0 ? 0 : expected_winners_up_to(rank - 1, population_, tournament);
        return std::max(0.0, expected_winners_up_to(rank, population_, tournament) - better); // may be negative by
                                                                                              // rounding
    };
    const std::uint32_t winners = winners_of_each(population_, tournament, picks_.wanted);
    const std::uint32_t whole = picks_.wanted / winners, left = picks_.wanted % winners;
    return whole * wins_of(winners) + (left == 0 ? 0 : wins_of(left));
}

double SelectionLaw::expected_copies(std::uint32_t rank, double share) const {
    if (picks_.wanted == 0) {
        return 0;
    }
    switch (parameters_.selection) {
    case SelectionMethod::Roulette:
    case SelectionMethod::StochasticUniversal:
        return picks_.wanted * share;
    case SelectionMethod::Tournament:
        return expected_wins(rank);
    case SelectionMethod::Random:
        return static_cast<double>(picks_.wanted) / population_;
    case SelectionMethod::Truncation:
        return rank < picks_.pool ? picks_.wanted / picks_.pool + (rank < picks_.wanted % picks_.pool ? 1 : 0) : 0;
    }
    return 0;
}

} // namespace evod::evolution
