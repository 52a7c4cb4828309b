#include "client/viewer/panels/breeding/theory.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

namespace evod::viewer {

namespace {

using Method = Selection::Method;
using Pressure = Selection::Pressure;

double sum(std::span<const double> numbers) {
    return std::accumulate(numbers.begin(), numbers.end(), 0.0);
}

// ---- the normal distribution -----------------------------------------------------------------------------------

double density(double z) {
    return std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
}

/// Returns the value that a standard normal variable exceeds with probability `above`. Newton's method converges
/// because the logarithm of this probability is concave.
double upper_normal_quantile(double above) {
    if (above > 0.5) {
        return -upper_normal_quantile(1 - above);
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

/// Divides the normal distribution into as many intervals of equal probability as there are ranks. Returns the mean
/// within each interval, for the best rank first. The sum is 0.
std::vector<double> normal_scores(std::size_t population) {
    std::vector<double> scores(population);
    const auto count = static_cast<double>(population);
    const auto density_above = [&](std::size_t ranks) {
        return ranks == 0 || ranks == population ? 0
                                                 : density(upper_normal_quantile(static_cast<double>(ranks) / count));
    };
    double before = 0;
    for (std::size_t rank = 0; rank < population; ++rank) {
        const double after = density_above(rank + 1);
        scores[rank] = count * (after - before);
        before = after;
    }
    return scores;
}

/// Returns (fitness − mean) / standard deviation for each organism; all 0 if all fitness values are equal.
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

/// Returns the mean of the scores, weighted by the copies.
double copy_weighted_mean(std::span<const double> copies, std::span<const double> scores) {
    const double all = sum(copies);
    return all > 0 ? std::inner_product(copies.begin(), copies.end(), scores.begin(), 0.0) / all : 0;
}

// ---- standard errors: how far two breedings of the same population differ ----------------------------------------

/// Returns the standard error of the mean score of the picked organisms. Returns nullopt if the picks depend on each
/// other in a way for which no simple formula exists.
std::optional<double> standard_error_of_intensity(const Selection& selection, const Expectation& expectation,
                                                  std::span<const double> scores) {
    const auto population = static_cast<double>(scores.size());
    const double picks = selection.picks;
    if (selection.method == Method::Truncation) {
        return 0;
    }
    if (selection.method == Method::Random) { // picks in full rounds do not vary: each round picks every organism once
        const double rest = std::fmod(picks, population);
        const double square = std::inner_product(scores.begin(), scores.end(), scores.begin(), 0.0) / population;
        return population > 1 ? std::sqrt(square * rest * (population - rest) / (population - 1)) / picks : 0;
    }
    if (!selection.independent_picks) {
        return std::nullopt;
    }
    const double mean = copy_weighted_mean(expectation.copies, scores);
    double square = 0;
    for (std::size_t rank = 0; rank < scores.size(); ++rank) {
        square += expectation.copies[rank] / picks * (scores[rank] - mean) * (scores[rank] - mean);
    }
    return std::sqrt(square / picks);
}

/// Returns the standard error of the share of organisms that are not selected. For independent picks, it follows from
/// the variance of the number of empty cells in large populations: Σ(q − q²) − (Σ λq)²/picks. Here λ is an organism's
/// expected number of copies, and q is its probability of having none.
std::optional<double> standard_error_of_unpicked(const Selection& selection, const Expectation& expectation) {
    if (selection.method == Method::Truncation || selection.method == Method::Random) {
        return 0;
    }
    if (!selection.independent_picks) {
        return std::nullopt;
    }
    double variance = 0, common = 0;
    for (std::size_t rank = 0; rank < expectation.copies.size(); ++rank) {
        const double unpicked = expectation.unpicked_chance[rank];
        variance += unpicked * (1 - unpicked);
        common += expectation.copies[rank] * unpicked;
    }
    variance -= common * common / selection.picks;
    return std::sqrt(std::max(variance, 0.0)) / static_cast<double>(expectation.copies.size());
}

/// Sets `prediction` to Pearson's chi-square of all copies, divided by the number of ranks. Its mean and standard
/// deviation are exact for small numbers of picks too. Source: Haldane 1937, "The exact value of the moments of the
/// distribution of χ²", Biometrika 29.
void set_agreement(Prediction& prediction, const Selection& selection, const Expectation& expectation,
                   std::span<const std::uint32_t> copies) {
    if (!selection.independent_picks) {
        return;
    }
    const double picks = selection.picks;
    double square = 0, inverse = 0, ranks = 0;
    for (std::size_t rank = 0; rank < expectation.copies.size(); ++rank) {
        const double expected = expectation.copies[rank];
        // Ignore ranks this rare: the rounding error of their probability would outweigh the effect of the picks.
        if (expected < 1e-6 * picks / static_cast<double>(expectation.copies.size())) {
            continue;
        }
        ++ranks;
        inverse += picks / expected;
        if (!copies.empty()) {
            square += (copies[rank] - expected) * (copies[rank] - expected) / expected;
        }
    }
    prediction.expected = (ranks - 1) / ranks;
    prediction.standard_error =
        std::sqrt(std::max(2 * (ranks - 1) + (inverse - ranks * ranks - 2 * ranks + 2) / picks, 0.0)) / ranks;
    if (!copies.empty()) {
        prediction.observed = square / ranks;
    }
}

// ---- takeover --------------------------------------------------------------------------------------------------

constexpr std::uint32_t generations_max = 10'000'000; // a longer takeover counts as never

/// On a wheel with unscaled fitness, an organism's share after t generations is f^t / Σ f^t, where f is its fitness.
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
            return std::nullopt; // takeover never happens, because all fitness values are equal
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
    return copy_weighted_mean(copies, standard_scores(fitness));
}

double normal_selection_intensity(std::span<const double> copies) {
    return copy_weighted_mean(copies, normal_scores(copies.size()));
}

double loss_of_diversity(std::span<const double> copies) {
    const double all = sum(copies), each = 1 / static_cast<double>(copies.size());
    double lost = 0;
    for (const double number : copies) {
        lost += all > 0 ? std::max(each - number / all, 0.0) : 0;
    }
    return lost;
}

std::optional<std::uint32_t> takeover_generations(const Selection& selection, std::span<const double> copies,
                                                  std::span<const double> fitness) {
    if (copies.size() <= 1) {
        return 0;
    }
    if (selection.overlapping || selection.pressure == Pressure::WindowedFitness) {
        return std::nullopt;
    }
    if (selection.pressure == Pressure::Fitness) {
        return takeover_on_wheel(fitness);
    }
    if (copies.front() - copies.back() <= 1e-12 * copies.front()) {
        return std::nullopt; // all organisms have the same chance
    }
    // Entry n is the expected number of picks of the n best ranks together.
    std::vector<double> picks_up_to{0};
    for (const double number : copies) {
        picks_up_to.push_back(picks_up_to.back() + number);
    }
    const auto population = static_cast<double>(copies.size());
    const double each = picks_up_to.back() / population;
    double places = 1;
    for (std::uint32_t generation = 0; generation < generations_max; ++generation) {
        if (places >= population - 1 - 1e-9) {
            return generation;
        }
        const auto rank = static_cast<std::size_t>(places);
        const double part = places - static_cast<double>(rank);
        places = std::min((picks_up_to[rank] * (1 - part) + picks_up_to[rank + 1] * part) / each, population);
    }
    return std::nullopt;
}

Selection selection_of(const evod::v1::Breeding& breeding) {
    const auto choice = [&](std::string_view name) -> std::string_view {
        for (const evod::v1::ParameterAssignment& parameter : breeding.parameters()) {
            if (parameter.name() == name) {
                return parameter.value().choice();
            }
        }
        return {};
    };
    const auto index_of = [](std::string_view wanted, std::initializer_list<std::string_view> names) {
        const auto found = std::find(names.begin(), names.end(), wanted);
        return found == names.end() ? 0 : found - names.begin();
    };
    Selection selection{.picks = breeding.pick_count()};
    selection.method = static_cast<Method>(
        index_of(choice("selection"), {"roulette", "stochastic_universal", "tournament", "random", "truncation"}));
    const std::string_view scaling = choice("fitness_scaling");
    const bool wheel = selection.method == Method::Roulette || selection.method == Method::StochasticUniversal;
    selection.pressure = !wheel || scaling == "linear_ranking" || scaling == "exponential_ranking" ? Pressure::Rank
                         : scaling == "windowing" ? Pressure::WindowedFitness
                                                  : Pressure::Fitness;
    std::uint32_t winners = 1;
    for (const evod::v1::ParameterAssignment& parameter : breeding.parameters()) {
        winners = parameter.name() == "tournament_winners" ? parameter.value().count() : winners;
    }
    selection.independent_picks = selection.method == Method::Roulette ||
                                  (selection.method == Method::Tournament && std::min(winners, selection.picks) == 1);
    selection.overlapping = choice("population_model") == "steady_state";
    return selection;
}

double deviation(double observed, double expected, double standard_error) {
    const double difference = observed - expected;
    if (std::abs(difference) <= 1e-9 * std::max(std::abs(expected), 1.0)) {
        return 0;
    }
    return standard_error > 0 ? difference / standard_error
                              : std::copysign(std::numeric_limits<double>::infinity(), difference);
}

std::optional<double> Prediction::deviation() const {
    if (!expected || !observed || !standard_error) {
        return std::nullopt;
    }
    return viewer::deviation(*observed, *expected, *standard_error);
}

std::vector<Prediction> predictions(const Selection& selection, const Expectation& expectation,
                                    std::span<const double> fitness, std::span<const std::uint32_t> copies) {
    if (selection.picks == 0) {
        return {};
    }
    const auto population = static_cast<double>(expectation.copies.size());
    const std::vector<double> counted(copies.begin(), copies.end());
    const bool known = !counted.empty();
    std::vector<Prediction> all;

    Prediction& fittest =
        all.emplace_back(Prediction{.name = "Copies of the fittest",
                                    .sentence = "How often the organism with the best fitness is picked.",
                                    .source = selection.method == Method::StochasticUniversal ? "Baker 1987"
                                              : selection.method == Method::Tournament        ? "Goldberg & Deb 1991"
                                                                                              : "Blickle & Thiele 1996",
                                    .expected = expectation.copies.front(),
                                    .standard_error = expectation.standard_error.front()});
    fittest.observed = known ? std::optional{counted.front()} : std::nullopt;

    const auto add_intensity = [&](std::string_view name, std::string_view sentence, std::span<const double> scores) {
        Prediction& intensity =
            all.emplace_back(Prediction{.name = name,
                                        .sentence = sentence,
                                        .source = "Blickle & Thiele 1996",
                                        .unit = "deviations",
                                        .expected = copy_weighted_mean(expectation.copies, scores),
                                        .standard_error = standard_error_of_intensity(selection, expectation, scores)});
        intensity.observed = known ? std::optional{copy_weighted_mean(counted, scores)} : std::nullopt;
    };
    add_intensity(
        "Selection intensity",
        "By how many standard deviations the mean fitness of the picked organisms exceeds the mean fitness of all "
        "organisms.",
        standard_scores(fitness));
    if (selection.pressure == Pressure::Rank) {
        add_intensity(
            "Intensity, normal fitness",
            "The selection intensity if the fitness had a normal distribution: it would depend only on the ranks.",
            normal_scores(expectation.copies.size()));
    }

    Prediction& unpicked = all.emplace_back(Prediction{
        .name = "Share not selected",
        .sentence = "The share of organisms that are never picked; genes that only these organisms had are lost.",
        .source = "Motoki 2002",
        .expected = sum(expectation.unpicked_chance) / population,
        .standard_error = standard_error_of_unpicked(selection, expectation)});
    if (known) {
        unpicked.observed = static_cast<double>(std::count(copies.begin(), copies.end(), 0u)) / population;
    }
    all.push_back({.name = "Loss of diversity",
                   .sentence =
                       "The share of the population that copies of fitter organisms replace if every organism has "
                       "its expected number of copies: the least possible loss.",
                   .source = "Blickle & Thiele 1996",
                   .expected = loss_of_diversity(expectation.copies)});

    const auto takeover = takeover_generations(selection, expectation.copies, fitness);
    all.push_back(
        {.name = "Takeover time",
         .sentence = selection.overlapping
                         ? "Generations until copies of the fittest fill all places but one; not predicted if most "
                           "of a generation survives."
                     : takeover ? "Generations of selection alone, without mutation and crossover, until copies of "
                                  "the fittest fill all places but one."
                     : selection.pressure != Pressure::Rank
                         ? "Generations until copies of the fittest fill all places but one; not predicted if each "
                           "generation subtracts its lowest fitness, or if all fitness values are equal."
                         : "Generations until copies of the fittest fill all places but one: never, because every "
                           "organism has the same chance.",
         .source = "Goldberg & Deb 1991",
         .unit = "generations",
         .expected = takeover ? std::optional<double>{*takeover} : std::nullopt});

    Prediction agreement{.name = "Agreement of all copies",
                         .sentence = "Squared differences between observed and expected copies, each divided by the "
                                     "expected copies (chi-square per organism): about 1 if the law holds.",
                         .source = "Pearson 1900; Haldane 1937"};
    set_agreement(agreement, selection, expectation, copies);
    if (agreement.expected) {
        all.push_back(agreement);
    }
    return all;
}

} // namespace evod::viewer
