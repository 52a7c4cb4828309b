#include "client/viewer/panels/breeding/theory.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace evod::viewer {

namespace {

using Method = Selection::Method;
using Scaling = Selection::Scaling;

/// `share` of `count`, to the nearest, half up; at least 1.
std::uint32_t share_of(std::uint32_t count, double share) {
    return std::max(1u, std::min(count, static_cast<std::uint32_t>(share * count + 0.5)));
}

double sum(std::span<const double> numbers) {
    return std::accumulate(numbers.begin(), numbers.end(), 0.0);
}

// ---- distributions ---------------------------------------------------------------------------------------------

double log_choose(double of, double choose) {
    return std::lgamma(of + 1) - std::lgamma(choose + 1) - std::lgamma(of - choose + 1);
}

/// Calls visit(number, chance) for the numbers below `end` that have a chance worth speaking of, rising.
///
/// chance_of  the chance of a number, from nothing but it.
/// ratio      the chance of the next number divided by the chance of this one.
template <class ChanceOf, class Ratio, class Visit>
void visit_near(double mean, double deviation, double least, double greatest, double end, ChanceOf chance_of,
                Ratio ratio, Visit visit) {
    const double reach = 10 * deviation + 30; // beyond it lies less than 10^-20
    double number = std::max(least, std::floor(mean - reach));
    const double last = std::min({greatest, std::ceil(mean + reach), end - 1});
    if (number > last) {
        return;
    }
    for (double chance = chance_of(number);; chance *= ratio(number), ++number) {
        visit(number, chance);
        if (number >= last) {
            return;
        }
    }
}

/// How often something of this chance happens in so many trials; visits as above.
template <class Visit>
void visit_binomial(double trials, double chance, double end, Visit visit) {
    if (chance <= 0 || chance >= 1) {
        const double number = chance <= 0 ? 0 : trials;
        if (number < end) {
            visit(number, 1.0);
        }
        return;
    }
    const auto chance_of = [=](double number) {
        return std::exp(log_choose(trials, number) + number * std::log(chance) +
                        (trials - number) * std::log1p(-chance));
    };
    visit_near(
        trials * chance, std::sqrt(trials * chance * (1 - chance)), 0, trials, end, chance_of,
        [=](double number) { return (trials - number) / (number + 1) * chance / (1 - chance); }, visit);
}

/// How many marked ones are among so many drawn without putting any back; visits as above.
template <class Visit>
void visit_hypergeometric(double all, double marked, double drawn, double end, Visit visit) {
    if (all <= 0) {
        visit(0.0, 1.0);
        return;
    }
    const double share = marked / all, whole = log_choose(all, drawn);
    visit_near(
        drawn * share, std::sqrt(drawn * share * (1 - share)), std::max(0.0, drawn + marked - all),
        std::min(marked, drawn), end,
        [=](double number) {
            return std::exp(log_choose(marked, number) + log_choose(all - marked, drawn - number) - whole);
        },
        [=](double number) {
            return (marked - number) / (number + 1) * ((drawn - number) / (all - marked - drawn + number + 1));
        },
        visit);
}

// ---- what each rank wins of one tournament ---------------------------------------------------------------------

struct Wins {
    double mean = 0;
    double square = 0; // mean of the square
    double none = 1;   // chance of no win
};

/// The rank wins once if it is drawn and fewer than `winners` of those drawn are better.
Wins wins_of_different(double population, double rank, double size, double winners) {
    double place_left = 0;
    visit_hypergeometric(population - 1, rank, size - 1, winners, [&](double, double chance) { place_left += chance; });
    const double wins = size / population * std::min(place_left, 1.0);
    return {wins, wins, 1 - wins};
}

/// It may be drawn several times, and win as often as there is a place left by the better ones.
Wins wins_of_repeated(double population, double rank, double size, double winners) {
    if (winners == 1) { // ((n−r)^k − (n−r−1)^k) / n^k
        const double wins =
            std::pow((population - rank) / population, size) - std::pow((population - rank - 1) / population, size);
        return {wins, wins, 1 - wins};
    }
    Wins wins{0, 0, 0};
    double some = 0;
    visit_binomial(size, 1 / population, size + 1, [&](double drawn, double chance_drawn) {
        if (drawn == 0) {
            return;
        }
        const double better_chance = population > 1 ? rank / (population - 1) : 0;
        visit_binomial(size - drawn, better_chance, winners, [&](double better, double chance) {
            const double won = std::min(drawn, winners - better);
            wins.mean += chance_drawn * chance * won;
            wins.square += chance_drawn * chance * won * won;
            some += chance_drawn * chance;
        });
    });
    wins.none = std::max(1 - some, 0.0);
    return wins;
}

Expectation expect_of_tournaments(const Selection& selection) {
    const double population = selection.population;
    const bool replacement = selection.tournament_replacement;
    const std::uint32_t size = std::max(
        replacement ? selection.tournament_size : std::min(selection.tournament_size, selection.population), 1u);
    const std::uint32_t winners =
        std::max(std::min({selection.tournament_winners, size, std::max(selection.picks, 1u)}), 1u);
    const std::uint32_t whole = selection.picks / winners, rest = selection.picks % winners; // the last drops a surplus
    const auto wins_at = [&](double rank, double places) {
        return replacement ? wins_of_repeated(population, rank, size, places)
                           : wins_of_different(population, rank, size, places);
    };
    Expectation expectation;
    for (std::uint32_t rank = 0; rank < selection.population; ++rank) {
        const Wins each = wins_at(rank, winners);
        const Wins last = rest > 0 ? wins_at(rank, rest) : Wins{};
        const auto variance = [](const Wins& wins) { return std::max(wins.square - wins.mean * wins.mean, 0.0); };
        expectation.copies.push_back(whole * each.mean + last.mean);
        expectation.standard_error.push_back(std::sqrt(whole * variance(each) + variance(last)));
        expectation.missed.push_back(std::pow(each.none, whole) * last.none);
    }
    return expectation;
}

// ---- wheels ----------------------------------------------------------------------------------------------------

/// The width of each slot, best first; the sum is 1.
std::vector<double> slots_of(const Selection& selection, std::span<const double> fitness) {
    const std::uint32_t population = selection.population;
    std::vector<double> slots(population, 1.0);
    const bool by_fitness = selection.scaling == Scaling::None || selection.scaling == Scaling::Windowing;
    if (selection.scaling == Scaling::LinearRanking && population > 1) {
        const double pressure = selection.ranking_pressure;
        for (std::uint32_t rank = 0; rank < population; ++rank) {
            slots[rank] = pressure - 2 * (pressure - 1) * rank / (population - 1.0);
        }
    } else if (selection.scaling == Scaling::ExponentialRanking) {
        for (std::uint32_t rank = 1; rank < population; ++rank) {
            slots[rank] = slots[rank - 1] * selection.ranking_decay;
        }
    } else if (by_fitness && !fitness.empty()) {
        // Quarters, as a difference of two doubles may be more than a double holds.
        const double least = fitness.back() / 4;
        const double floor = selection.scaling == Scaling::Windowing ? least : std::min(least, 0.0);
        const double greatest = fitness.front() / 4 - floor;
        for (std::uint32_t rank = 0; greatest > 0 && rank < population; ++rank) {
            slots[rank] = (fitness[rank] / 4 - floor) / greatest;
        }
    }
    const double all = sum(slots);
    for (double& slot : slots) {
        slot /= all;
    }
    return slots;
}

/// Exactly ⌊copies⌋ or ⌈copies⌉, which is what universal sampling, truncation and the drawing of everyone in turn do.
void add_rounded(Expectation& expectation, double copies) {
    const double nearest = std::round(copies);
    // To within the rounding of a sum of doubles a whole number is one.
    const double part = std::abs(copies - nearest) < 1e-9 * std::max(copies, 1.0) ? 0 : copies - std::floor(copies);
    expectation.copies.push_back(copies);
    expectation.standard_error.push_back(std::sqrt(part * (1 - part)));
    expectation.missed.push_back(std::max(0.0, 1 - copies));
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

// ---- what is asked ---------------------------------------------------------------------------------------------

Selection selection_of(const google::protobuf::RepeatedPtrField<evod::v1::ParameterAssignment>& parameters,
                       std::uint32_t present, std::uint32_t wanted) {
    Selection selection;
    double survivors = 0.5;
    std::uint32_t elite = 0, replaced = 2;
    std::string_view model = "hybrid";
    for (const evod::v1::ParameterAssignment& parameter : parameters) {
        const std::string& name = parameter.name();
        const evod::v1::ParameterValue& value = parameter.value();
        const auto choose = [&](auto& choice, std::initializer_list<std::string_view> names) {
            const auto found = std::find(names.begin(), names.end(), value.choice());
            if (found != names.end()) {
                choice = static_cast<std::remove_reference_t<decltype(choice)>>(found - names.begin());
            }
        };
        if (name == "selection") {
            choose(selection.method, {"roulette", "stochastic_universal", "tournament", "random", "truncation"});
        } else if (name == "fitness_scaling") {
            choose(selection.scaling, {"none", "windowing", "linear_ranking", "exponential_ranking"});
        } else if (name == "population_model") {
            model = value.choice();
        } else if (name == "ranking_pressure") {
            selection.ranking_pressure = value.real();
        } else if (name == "ranking_decay") {
            selection.ranking_decay = value.real();
        } else if (name == "tournament_size") {
            selection.tournament_size = value.count();
        } else if (name == "tournament_winners") {
            selection.tournament_winners = value.count();
        } else if (name == "tournament_replacement") {
            selection.tournament_replacement = value.flag();
        } else if (name == "survivors") {
            survivors = value.real();
        } else if (name == "elite_count") {
            elite = value.count();
        } else if (name == "replaced_count") {
            replaced = value.count();
        }
    }
    selection.population = std::max(present, 1u);
    const std::uint32_t common = std::min(present, wanted);
    elite = std::min(elite, common);
    if (model == "hybrid") { // the picked survive, and breed
        selection.picks = std::max(share_of(wanted, survivors), elite);
        selection.pool = selection.population;
    } else {
        selection.overlapping = model == "steady_state";
        const std::uint32_t stay = selection.overlapping ? common - std::min(replaced, common) : 0;
        const std::uint32_t children = wanted - std::min(std::max(stay, elite), wanted);
        selection.picks = children > 0 ? std::max(2u, children) : 0;
        selection.pool = share_of(selection.population, survivors);
    }
    return selection;
}

Expectation expect(const Selection& selection, std::span<const double> fitness) {
    if (selection.method == Method::Tournament) {
        return expect_of_tournaments(selection);
    }
    Expectation expectation;
    const double picks = selection.picks;
    if (selection.turns_a_wheel()) {
        for (const double slot : slots_of(selection, fitness)) {
            if (selection.method == Method::StochasticUniversal) {
                add_rounded(expectation, picks * slot);
                continue;
            }
            expectation.copies.push_back(picks * slot);
            expectation.standard_error.push_back(std::sqrt(picks * slot * (1 - slot)));
            expectation.missed.push_back(std::pow(1 - slot, picks));
        }
        return expectation;
    }
    for (std::uint32_t rank = 0; rank < selection.population; ++rank) {
        if (selection.method == Method::Random) {
            add_rounded(expectation, picks / selection.population);
        } else {
            const bool in_pool = rank < selection.pool;
            const std::uint32_t surplus = selection.picks % selection.pool;
            add_rounded(expectation, in_pool ? selection.picks / selection.pool + (rank < surplus ? 1 : 0) : 0);
        }
    }
    return expectation;
}

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

    if (!fitness.empty()) {
        const std::vector<double> scores = standard_scores(fitness);
        Finding& intensity = all.emplace_back(
            Finding{.name = "Selection intensity",
                    .sentence = "By how many of its standard deviations the mean fitness of those picked is above "
                                "the mean of all.",
                    .source = "Blickle & Thiele 1996",
                    .unit = "deviations",
                    .expected = mean_of_copies(expectation.copies, scores),
                    .standard_error = error_of_intensity(selection, expectation, scores)});
        intensity.happened = known ? std::optional{mean_of_copies(counted, scores)} : std::nullopt;
    }
    const bool by_rank = !selection.turns_a_wheel() || selection.scaling == Scaling::LinearRanking ||
                         selection.scaling == Scaling::ExponentialRanking;
    if (by_rank) {
        const std::vector<double> scores = normal_scores(selection.population);
        Finding& intensity = all.emplace_back(
            Finding{.name = "Intensity, normal fitness",
                    .sentence = "The selection intensity if the fitness were spread as a normal distribution: it then "
                                "depends on the ranks alone.",
                    .source = "Blickle & Thiele 1996",
                    .unit = "deviations",
                    .expected = mean_of_copies(expectation.copies, scores),
                    .standard_error = error_of_intensity(selection, expectation, scores)});
        intensity.happened = known ? std::optional{mean_of_copies(counted, scores)} : std::nullopt;
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
