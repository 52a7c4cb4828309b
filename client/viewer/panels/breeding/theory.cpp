#include "client/viewer/panels/breeding/theory.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace evod::viewer {

namespace {

using Method = Selection::Method;
using Scaling = Selection::Scaling;

double sum(std::span<const double> numbers) {
    return std::accumulate(numbers.begin(), numbers.end(), 0.0);
}

// ---- the normal distribution -----------------------------------------------------------------------------------

double density(double z) {
    return std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
}

/// The z above which the share `above` of a normal distribution lies. Newton's method on its logarithm, which is
/// concave and so cannot miss.
double normal_above(double above) {
    if (above > 0.5) {
        return -normal_above(1 - above);
    }
    double z = 0;
    for (int i = 0; i < 60; ++i) {
        const double share = std::erfc(z / std::numbers::sqrt2) / 2;
        const double step = std::log(share / above) * share / density(z);
        z += step;
        if (std::abs(step) < 1e-14 * std::max(1.0, z)) {
            break;
        }
    }
    return z;
}

/// The mean of a normal distribution over the slice of each rank, best first: the sum is 0.
std::vector<double> normal_scores(std::size_t population) {
    std::vector<double> scores(population);
    const auto count = static_cast<double>(population);
    const auto density_above = [&](std::size_t ranks) {
        return ranks == 0 || ranks == population ? 0 : density(normal_above(static_cast<double>(ranks) / count));
    };
    double before = 0;
    for (std::size_t rank = 0; rank < population; ++rank) {
        const double after = density_above(rank + 1);
        scores[rank] = count * (after - before);
        before = after;
    }
    return scores;
}

/// How far each fitness is above the mean, in deviations; all 0 where all are alike.
std::vector<double> standard_scores(std::span<const double> fitness) {
    const auto count = static_cast<double>(fitness.size());
    const double mean = sum(fitness) / count;
    double square = 0;
    for (const double value : fitness) {
        square += (value - mean) * (value - mean) / count;
    }
    std::vector<double> scores;
    for (const double value : fitness) {
        scores.push_back(square > 0 && std::isfinite(square) ? (value - mean) / std::sqrt(square) : 0);
    }
    return scores;
}

/// The mean score of the copies.
double mean_of_copies(std::span<const double> copies, std::span<const double> scores) {
    const double all = sum(copies);
    return all > 0 ? std::inner_product(copies.begin(), copies.end(), scores.begin(), 0.0) / all : 0;
}

// ---- how far apart two breedings of the same population are ------------------------------------------------------

/// Whether each pick is made without regard to the others.
bool picks_are_independent(const Selection& selection) {
    return selection.method == Method::Roulette ||
           (selection.method == Method::Tournament && std::min(selection.tournament_winners, selection.picks) == 1);
}

/// Of the mean score of the picked; nullopt where picks hang together in a way that has no simple law.
std::optional<double> error_of_intensity(const Selection& selection, const Expectation& expectation,
                                         std::span<const double> scores) {
    const double picks = selection.picks, population = selection.population;
    if (selection.method == Method::Truncation) {
        return 0;
    }
    if (selection.method == Method::Random) { // all the same for everyone, but in the last round
        const double rest = selection.picks % selection.population;
        const double square = std::inner_product(scores.begin(), scores.end(), scores.begin(), 0.0) / population;
        return population > 1 ? std::sqrt(square * rest * (population - rest) / (population - 1)) / picks : 0;
    }
    if (!picks_are_independent(selection)) {
        return std::nullopt;
    }
    const double mean = mean_of_copies(expectation.copies, scores);
    double square = 0;
    for (std::size_t rank = 0; rank < scores.size(); ++rank) {
        square += expectation.copies[rank] / picks * (scores[rank] - mean) * (scores[rank] - mean);
    }
    return std::sqrt(square / picks);
}

/// Of the share that is not selected. For independent picks the variance of the number of empty cells, as it is in
/// large populations: Σ(q − q²) − (Σ λq)²/picks, where λ copies are expected and q is the chance of none.
std::optional<double> error_of_missed(const Selection& selection, const Expectation& expectation) {
    if (selection.method == Method::Truncation || selection.method == Method::Random) {
        return 0;
    }
    if (!picks_are_independent(selection)) {
        return std::nullopt;
    }
    double variance = 0, common = 0;
    for (std::size_t rank = 0; rank < expectation.copies.size(); ++rank) {
        const double missed = expectation.missed[rank];
        variance += missed * (1 - missed);
        common += expectation.copies[rank] * missed;
    }
    variance -= common * common / selection.picks;
    return std::sqrt(std::max(variance, 0.0)) / selection.population;
}

/// Pearson's chi-square of all copies, with its mean and standard deviation, which are exact however small the numbers
/// are. Source: Haldane 1937, "The exact value of the moments of the distribution of χ²", Biometrika 29.
void take_agreement(Finding& finding, const Selection& selection, const Expectation& expectation,
                    std::span<const std::uint32_t> copies) {
    if (!picks_are_independent(selection)) {
        return;
    }
    const double picks = selection.picks;
    double square = 0, inverse = 0, ranks = 0;
    for (std::size_t rank = 0; rank < expectation.copies.size(); ++rank) {
        const double expected = expectation.copies[rank];
        // So rare that it would say more of the last digits of a chance than of the picks.
        if (expected < 1e-6 * picks / selection.population) {
            continue;
        }
        ++ranks;
        inverse += picks / expected;
        if (!copies.empty()) {
            square += (copies[rank] - expected) * (copies[rank] - expected) / expected;
        }
    }
    finding.expected = (ranks - 1) / ranks;
    finding.standard_error =
        std::sqrt(std::max(2 * (ranks - 1) + (inverse - ranks * ranks - 2 * ranks + 2) / picks, 0.0)) / ranks;
    if (!copies.empty()) {
        finding.happened = square / ranks;
    }
}

// ---- takeover --------------------------------------------------------------------------------------------------

constexpr std::uint32_t generations_max = 10'000'000; // what takes longer is as good as never

/// On a wheel of the bare fitness an organism's share after t generations is f^t / Σ f^t.
std::optional<std::uint32_t> takeover_on_wheel(std::span<const double> fitness) {
    const double best = fitness.front(), goal = 1 - 1 / static_cast<double>(fitness.size());
    if (fitness.back() < 0 || best <= 0) {
        return std::nullopt;
    }
    const auto share = [&](double generations) {
        double first = 0, all = 0;
        for (const double value : fitness) {
            const double weight = value > 0 ? std::exp(generations * std::log(value / best)) : 0;
            all += weight;
            first += value == best ? weight : 0;
        }
        return first / all;
    };
    std::uint32_t after = 1;
    while (share(after) < goal) {
        if (after > generations_max) {
            return std::nullopt; // nobody differs
        }
        after *= 2;
    }
    std::uint32_t before = after / 2;
    while (after - before > 1) {
        const std::uint32_t middle = before + (after - before) / 2;
        (share(middle) < goal ? before : after) = middle;
    }
    return after;
}

} // namespace

double selection_intensity(std::span<const double> copies, std::span<const double> fitness) {
    return mean_of_copies(copies, standard_scores(fitness));
}

double normal_selection_intensity(std::span<const double> copies) {
    return mean_of_copies(copies, normal_scores(copies.size()));
}

double loss_of_diversity(std::span<const double> copies) {
    const double all = sum(copies), each = 1 / static_cast<double>(copies.size());
    double lost = 0;
    for (const double number : copies) {
        lost += all > 0 ? std::max(each - number / all, 0.0) : 0;
    }
    return lost;
}

std::optional<std::uint32_t> takeover_generations(const Selection& selection, std::span<const double> fitness) {
    if (selection.population <= 1) {
        return 0;
    }
    const bool by_fitness =
        selection.turns_a_wheel() && (selection.scaling == Scaling::None || selection.scaling == Scaling::Windowing);
    if (selection.overlapping || (by_fitness && (selection.scaling == Scaling::Windowing || fitness.empty()))) {
        return std::nullopt;
    }
    if (by_fitness) {
        return takeover_on_wheel(fitness);
    }
    const std::vector<double> copies = expect(selection, fitness).copies;
    if (copies.front() - copies.back() <= 1e-12 * copies.front()) {
        return std::nullopt; // nobody is preferred
    }
    // What the best so many ranks get of the picks together, times the population.
    std::vector<double> got{0};
    for (const double number : copies) {
        got.push_back(got.back() + number);
    }
    const double population = selection.population, each = got.back() / population;
    double places = 1;
    for (std::uint32_t generation = 0; generation < generations_max; ++generation) {
        if (places >= population - 1 - 1e-9) {
            return generation;
        }
        const auto rank = static_cast<std::size_t>(places);
        const double part = places - static_cast<double>(rank);
        places = std::min((got[rank] * (1 - part) + got[rank + 1] * part) / each, population);
    }
    return std::nullopt;
}

double deviation(double happened, double expected, double standard_error) {
    const double difference = happened - expected;
    if (std::abs(difference) <= 1e-9 * std::max(std::abs(expected), 1.0)) {
        return 0;
    }
    return standard_error > 0 ? difference / standard_error
                              : std::copysign(std::numeric_limits<double>::infinity(), difference);
}

std::optional<double> Finding::deviation() const {
    if (!expected || !happened || !standard_error) {
        return std::nullopt;
    }
    return viewer::deviation(*happened, *expected, *standard_error);
}

std::vector<Finding> findings(const Selection& selection, std::span<const double> fitness,
                              std::span<const std::uint32_t> copies) {
    if (selection.picks == 0) {
        return {}; // nobody breeds
    }
    const Expectation expectation = expect(selection, fitness);
    const double population = selection.population;
    const std::vector<double> counted(copies.begin(), copies.end());
    const bool known = !counted.empty();
    std::vector<Finding> all;

    Finding& fittest =
        all.emplace_back(Finding{.name = "Copies of the fittest",
                                 .sentence = "How often the organism with the best fitness is picked.",
                                 .source = selection.method == Method::StochasticUniversal ? "Baker 1987"
                                           : selection.method == Method::Tournament        ? "Goldberg & Deb 1991"
                                                                                           : "Blickle & Thiele 1996",
                                 .expected = expectation.copies.front(),
                                 .standard_error = expectation.standard_error.front()});
    fittest.happened = known ? std::optional{counted.front()} : std::nullopt;

    const auto add_intensity = [&](std::string_view name, std::string_view sentence, std::span<const double> scores) {
        Finding& intensity =
            all.emplace_back(Finding{.name = name,
                                     .sentence = sentence,
                                     .source = "Blickle & Thiele 1996",
                                     .unit = "deviations",
                                     .expected = mean_of_copies(expectation.copies, scores),
                                     .standard_error = error_of_intensity(selection, expectation, scores)});
        intensity.happened = known ? std::optional{mean_of_copies(counted, scores)} : std::nullopt;
    };
    if (!fitness.empty()) {
        add_intensity(
            "Selection intensity",
            "By how many of its standard deviations the mean fitness of those picked is above the mean of all.",
            standard_scores(fitness));
    }
    const bool by_rank = !selection.turns_a_wheel() || selection.scaling == Scaling::LinearRanking ||
                         selection.scaling == Scaling::ExponentialRanking;
    if (by_rank) {
        add_intensity("Intensity, normal fitness",
                      "The selection intensity if the fitness were spread as a normal distribution: it then depends on "
                      "the ranks alone.",
                      normal_scores(selection.population));
    }

    Finding& missed = all.emplace_back(Finding{.name = "Share not selected",
                                               .sentence = "Organisms that are never picked, as a share of all; what "
                                                           "only they had is lost.",
                                               .source = "Motoki 2002",
                                               .expected = sum(expectation.missed) / population,
                                               .standard_error = error_of_missed(selection, expectation)});
    if (known) {
        missed.happened = static_cast<double>(std::count(copies.begin(), copies.end(), 0u)) / population;
    }
    all.push_back({.name = "Loss of diversity",
                   .sentence = "The share of the population whose places go to fitter ones if all happens as expected: "
                               "the least share that can be lost.",
                   .source = "Blickle & Thiele 1996",
                   .expected = loss_of_diversity(expectation.copies)});

    const auto takeover = takeover_generations(selection, fitness);
    all.push_back({.name = "Takeover time",
                   .sentence = selection.overlapping
                                   ? "Generations until copies of the fittest have all places but one; not told where "
                                     "most of a generation stays."
                               : takeover ? "Generations of selection alone, without mutation and crossover, until "
                                            "copies of the fittest have all places but one."
                               : selection.turns_a_wheel() && selection.scaling != Scaling::LinearRanking &&
                                       selection.scaling != Scaling::ExponentialRanking
                                   ? "Generations until copies of the fittest have all places but one; not told where "
                                     "the least fitness is taken off anew each time, or nobody differs."
                                   : "Generations until copies of the fittest have all places but one: never, as "
                                     "nobody is preferred.",
                   .source = "Goldberg & Deb 1991",
                   .unit = "generations",
                   .expected = takeover ? std::optional<double>{*takeover} : std::nullopt});

    Finding agreement{.name = "Agreement of all copies",
                      .sentence = "Squares of how far the copies of each are from what was expected, divided by that "
                                  "(chi-square per organism): about 1 if the law holds.",
                      .source = "Pearson 1900; Haldane 1937"};
    take_agreement(agreement, selection, expectation, copies);
    if (agreement.expected) {
        all.push_back(agreement);
    }
    return all;
}

} // namespace evod::viewer
