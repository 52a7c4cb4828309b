#include "server/evolution/selection_law.h"

#include "server/base/assert.h"
#include "server/base/elementary.h"
#include "server/evolution/tournament.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace evod::evolution {
namespace {

/// Returns x^n for n >= 0. x is a probability that may be slightly negative because of rounding.
double power(double x, double n) {
    if (x < std::numeric_limits<double>::min()) {
        return n == 0 ? 1 : 0;
    }
    return base::pow(x, n);
}

/// Calls visit(x, weight) for every x in [least, greatest] whose weight is not negligible. Weights are proportional to
/// the probabilities of x; the weight of `mode` is 1.
///
/// mode     the most probable x; the probability decreases on both sides of it.
/// ratio    ratio(x) = P(X = x + 1) / P(X = x).
/// returns  the sum of all weights.
template <class Ratio, class Visit>
double visit_weights(double least, double mode, double greatest, const Ratio& ratio, const Visit& visit) {
    constexpr double negligible = 1e-22;
    visit(mode, 1.0);
    double sum = 1;
    double weight = 1;
    for (double x = mode; x < greatest && weight > negligible; ++x) {
        weight *= ratio(x);
        sum += weight;
        visit(x + 1, weight);
    }
    weight = 1;
    for (double x = mode; x > least && weight > negligible; --x) {
        weight /= ratio(x - 1);
        sum += weight;
        visit(x - 1, weight);
    }
    return sum;
}

/// Calls visit_weights() for the binomial distribution: the number of successes in `trials` independent trials.
template <class Visit>
double visit_binomial(double trials, double chance, const Visit& visit) {
    if (chance >= 1) {
        visit(trials, 1.0);
        return 1;
    }
    const double mode = std::min(std::floor((trials + 1) * chance), trials), odds = chance / (1 - chance);
    return visit_weights(
        0, mode, trials, [=](double x) { return (trials - x) / (x + 1) * odds; }, visit);
}

/// Calls visit_weights() for the hypergeometric distribution: the number of marked items among `drawn` items that are
/// drawn from `all` without replacement.
template <class Visit>
double visit_hypergeometric(double all, double marked, double drawn, const Visit& visit) {
    const double least = std::max(0.0, drawn + marked - all), greatest = std::min(marked, drawn);
    const double mode = std::clamp(std::floor((drawn + 1) * ((marked + 1) / (all + 2))), least, greatest);
    return visit_weights(
        least, mode, greatest,
        [=](double x) { return (marked - x) / (x + 1) * ((drawn - x) / (all - marked - drawn + x + 1)); }, visit);
}

/// Computes the wins of a rank in a tournament without replacement. A rank wins at most once: if it is a contestant and
/// fewer than `winners` other contestants are fitter.
WinsLaw wins_without_replacement(double rank, double population, double size, double winners) {
    double place_left = 0;
    const double all = visit_hypergeometric(population - 1, rank, size - 1, [&](double fitter, double weight) {
        place_left += fitter < winners ? weight : 0;
    });
    const double chance = size / population * (place_left / all);
    return {chance, chance, 1 - chance};
}

/// Computes the wins of a rank in a tournament in which `contestants` contestants have this rank or a better one. Each
/// of these contestants has exactly this rank with probability `own_share`.
WinsLaw wins_among(double contestants, double own_share, double winners) {
    if (contestants <= winners) { // each of these contestants wins
        const double mean = contestants * own_share;
        return {mean, mean * (1 - own_share) + mean * mean, power(1 - own_share, contestants)};
    }
    const double losers = contestants - winners, own = contestants * own_share;
    if (losers > own + 10 * std::sqrt(own * (1 - own_share)) + 30) { // a win is less likely than 10^-20
        return {};
    }
    WinsLaw law{.none_chance = 0};
    const double all = visit_binomial(contestants, own_share, [&](double drawn, double weight) {
        const double won = std::max(drawn - losers, 0.0); // of these contestants, those with this rank lose first
        law.mean += weight * won;
        law.mean_square += weight * won * won;
        law.none_chance += won > 0 ? 0 : weight;
    });
    return {law.mean / all, law.mean_square / all, law.none_chance / all};
}

WinsLaw wins_with_replacement(double rank, double population, double size, double winners) {
    if (winners == 1) { // ((n−r)^k − (n−r−1)^k) / n^k
        const double chance =
            power((population - rank) / population, size) - power((population - rank - 1) / population, size);
        return {chance, chance, 1 - chance};
    }
    WinsLaw law{.none_chance = 0};
    const double all = visit_binomial(size, (rank + 1) / population, [&](double contestants, double weight) {
        const WinsLaw given = wins_among(contestants, 1 / (rank + 1), winners);
        law.mean += weight * given.mean;
        law.mean_square += weight * given.mean_square;
        law.none_chance += weight * given.none_chance;
    });
    return {law.mean / all, law.mean_square / all, law.none_chance / all};
}

/// Returns the distribution of the number of copies if that number is always ⌊expected⌋ or ⌈expected⌉, as in universal
/// sampling, truncation and random selection in rounds.
CopiesLaw rounded_copies(double expected) {
    const double nearest = std::round(expected);
    // A share of the wheel is a difference of rounded sums, so a number this close to a whole number is treated as
    // whole.
    const bool whole = std::abs(expected - nearest) < 1e-9 * std::max(expected, 1.0);
    const double part = whole ? 0 : expected - std::floor(expected);
    return {expected, std::sqrt(part * (1 - part)), std::max(0.0, 1 - expected)};
}

} // namespace

WinsLaw wins_of_rank(std::uint32_t rank, std::uint32_t population, const Tournament& tournament) {
    EVOD_ASSERT(rank < population);
    EVOD_ASSERT(tournament.winners >= 1);
    EVOD_ASSERT(tournament.winners <= tournament.size);
    return (tournament.replacement ? wins_with_replacement
                                   : wins_without_replacement)(rank, population, tournament.size, tournament.winners);
}

CopiesLaw SelectionLaw::tournament_copies(std::uint32_t rank) const {
    Tournament tournament = tournament_of(parameters_);
    if (!tournament.replacement) {
        tournament.size = std::min(tournament.size, population_);
    }
    const std::uint32_t winners = winners_of_each(population_, tournament, picks_.wanted);
    const std::uint32_t whole = picks_.wanted / winners, rest = picks_.wanted % winners;
    const auto wins_of = [&](std::uint32_t winners_of_this) {
        tournament.winners = winners_of_this;
        return wins_of_rank(rank, population_, tournament);
    };
    const auto variance = [](const WinsLaw& wins) { return std::max(wins.mean_square - wins.mean * wins.mean, 0.0); };
    const WinsLaw each = whole > 0 ? wins_of(winners) : WinsLaw{};
    const WinsLaw last = rest > 0 ? wins_of(rest) : WinsLaw{}; // the last tournament drops its surplus winners
    return {whole * each.mean + last.mean, std::sqrt(whole * variance(each) + variance(last)),
            power(each.none_chance, whole) * last.none_chance};
}

CopiesLaw SelectionLaw::copies(std::uint32_t rank, double share) const {
    EVOD_ASSERT(rank < population_);
    const double wanted = picks_.wanted;
    if (wanted == 0) {
        return {};
    }
    switch (parameters_.selection) {
    case SelectionMethod::Roulette:
        return {wanted * share, std::sqrt(wanted * share * (1 - share)), power(1 - share, wanted)};
    case SelectionMethod::StochasticUniversal:
        return rounded_copies(wanted * share);
    case SelectionMethod::Tournament:
        return tournament_copies(rank);
    case SelectionMethod::Random:
        return rounded_copies(wanted / population_);
    case SelectionMethod::Truncation:
        return rounded_copies(
            rank < picks_.pool ? picks_.wanted / picks_.pool + (rank < picks_.wanted % picks_.pool ? 1 : 0) : 0);
    }
    return {};
}

} // namespace evod::evolution
