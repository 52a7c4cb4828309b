// What theory foretells, against its closed forms and against what the server's own selection does.
#include "client/viewer/panels/breeding/theory.h"

#include "server/base/inline_executor.h"
#include "server/evolution/next_generation.h"
#include "server/evolution/selection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

namespace evod::viewer {
namespace {

using evolution::FitnessScaling;
using evolution::Parameters;
using evolution::SelectionMethod;

/// Best first, with equals among them.
std::vector<double> falling_fitness(std::uint32_t population) {
    std::vector<double> fitness;
    for (std::uint32_t rank = 0; rank < population; ++rank) {
        fitness.push_back(5.0 + 3.0 * std::floor((population - rank) / 2.0));
    }
    return fitness;
}

google::protobuf::RepeatedPtrField<evod::v1::ParameterAssignment> assignments_of(const Parameters& parameters) {
    google::protobuf::RepeatedPtrField<evod::v1::ParameterAssignment> all;
    const auto add = [&](const char* name) {
        all.Add()->set_name(name);
        return all.rbegin()->mutable_value();
    };
    constexpr const char* methods[] = {"roulette", "stochastic_universal", "tournament", "random", "truncation"};
    constexpr const char* scalings[] = {"none", "windowing", "linear_ranking", "exponential_ranking"};
    constexpr const char* models[] = {"hybrid", "generational", "steady_state"};
    add("selection")->set_choice(methods[static_cast<int>(parameters.selection)]);
    add("fitness_scaling")->set_choice(scalings[static_cast<int>(parameters.fitness_scaling)]);
    add("population_model")->set_choice(models[static_cast<int>(parameters.population_model)]);
    add("ranking_pressure")->set_real(parameters.ranking_pressure);
    add("ranking_decay")->set_real(parameters.ranking_decay);
    add("tournament_size")->set_count(parameters.tournament_size);
    add("tournament_winners")->set_count(parameters.tournament_winners);
    add("tournament_replacement")->set_flag(parameters.tournament_replacement);
    add("survivors")->set_real(parameters.survivors);
    add("elite_count")->set_count(parameters.elite_count);
    add("replaced_count")->set_count(parameters.replaced_count);
    add("mutation_chance")->set_real(0.5);
    return all;
}

Selection selection_with(const Parameters& parameters, std::uint32_t population, std::uint32_t picks,
                         std::uint32_t pool) {
    Selection selection = selection_of(assignments_of(parameters), population, population);
    selection.picks = picks;
    selection.pool = pool;
    return selection;
}

struct Law {
    const char* name;
    Parameters parameters;
    std::uint32_t population = 20, picks = 20, pool = 20;
};

std::vector<Law> laws() {
    std::vector<Law> all;
    const auto add = [&](const char* name, SelectionMethod method) -> Law& {
        Law& law = all.emplace_back(Law{.name = name, .parameters = {}});
        law.parameters.selection = method;
        return law;
    };
    add("roulette", SelectionMethod::Roulette);
    add("roulette, windowing", SelectionMethod::Roulette).parameters.fitness_scaling = FitnessScaling::Windowing;
    add("roulette, linear", SelectionMethod::Roulette).parameters.fitness_scaling = FitnessScaling::LinearRanking;
    add("universal, exponential", SelectionMethod::StochasticUniversal).parameters.fitness_scaling =
        FitnessScaling::ExponentialRanking;
    add("universal, more picks", SelectionMethod::StochasticUniversal).picks = 33;
    add("tournament", SelectionMethod::Tournament);
    for (const bool replacement : {true, false}) {
        for (const std::uint32_t winners : {1u, 2u, 4u, 5u}) {
            Law& law = add(replacement ? "winners" : "winners of different", SelectionMethod::Tournament);
            law.parameters.tournament_size = 5;
            law.parameters.tournament_winners = winners;
            law.parameters.tournament_replacement = replacement;
            law.picks = 23; // the last tournament has a surplus
        }
        Law& large = add(replacement ? "large" : "large, of different", SelectionMethod::Tournament);
        large.parameters.tournament_size = 90;
        large.parameters.tournament_winners = 3;
        large.parameters.tournament_replacement = replacement;
        large.population = 100;
    }
    add("random", SelectionMethod::Random).picks = 33;
    Law& truncation = add("truncation", SelectionMethod::Truncation);
    truncation.pool = 7;
    truncation.picks = 18;
    add("one organism", SelectionMethod::Tournament).population = 1;
    return all;
}

TEST(Theory, ForetellsWhatTheServerSelects) {
    // Means of 20,000 breedings, each within 6 standard errors: of some 2,000 comparisons a correct build fails in less
    // than one seed of 100,000.
    constexpr std::uint32_t breedings = 20'000;
    constexpr double within = 6;
    for (const Law& law : laws()) {
        SCOPED_TRACE(law.name + std::string{", winners "} + std::to_string(law.parameters.tournament_winners));
        const std::vector<double> fitness = falling_fitness(law.population);
        const Selection selection = selection_with(law.parameters, law.population, law.picks, law.pool);
        const Expectation expected = expect(selection, fitness);
        ASSERT_EQ(expected.copies.size(), law.population);
        EXPECT_NEAR(std::accumulate(expected.copies.begin(), expected.copies.end(), 0.0), law.picks, 1e-9);

        std::vector<double> total(law.population), squares(law.population), missed(law.population);
        std::vector<std::vector<double>> happened; // by finding, then breeding
        base::InlineExecutor executor;
        for (std::uint32_t breeding = 0; breeding < breedings; ++breeding) {
            evolution::Ranking ranking{fitness};
            std::vector<std::uint32_t> copies(law.population);
            for (const std::uint32_t organism :
                 evolution::select(ranking, {.wanted = law.picks, .pool = law.pool}, law.parameters,
                                   {base::Seed{8127}, base::Purpose::Selection, 0, breeding}, executor)) {
                ++copies[organism];
            }
            for (std::uint32_t rank = 0; rank < law.population; ++rank) {
                total[rank] += copies[rank];
                squares[rank] += double(copies[rank]) * copies[rank];
                missed[rank] += copies[rank] == 0;
            }
            if (breeding < 2000) {
                const auto found = findings(selection, fitness, copies);
                happened.resize(found.size());
                for (std::size_t i = 0; i < found.size(); ++i) {
                    if (found[i].happened) {
                        happened[i].push_back(*found[i].happened);
                    }
                }
            }
        }
        for (std::uint32_t rank = 0; rank < law.population; ++rank) {
            const double mean = total[rank] / breedings;
            const double error = expected.standard_error[rank];
            EXPECT_LE(std::abs(mean - expected.copies[rank]), within * error / std::sqrt(breedings) + 1e-9) << rank;
            // A count as rare as this has a fourth moment of about its mean.
            const double variance = squares[rank] / breedings - mean * mean;
            const double spread = std::sqrt((error * error + 3 * std::pow(error, 4)) / breedings);
            EXPECT_NEAR(variance, error * error, within * spread + 1e-9) << rank;
            const double chance = expected.missed[rank];
            EXPECT_NEAR(missed[rank] / breedings, chance, within * std::sqrt(chance * (1 - chance) / breedings) + 1e-9)
                << rank;
        }
        const auto foretold = findings(selection, fitness, {});
        ASSERT_EQ(foretold.size(), happened.size());
        for (std::size_t i = 0; i < foretold.size(); ++i) {
            if (!foretold[i].standard_error || happened[i].empty()) {
                continue;
            }
            SCOPED_TRACE(foretold[i].name);
            const auto count = static_cast<double>(happened[i].size());
            const double error = *foretold[i].standard_error;
            double mean = 0, square = 0;
            for (const double value : happened[i]) {
                mean += value / count;
                square += (value - *foretold[i].expected) * (value - *foretold[i].expected) / count;
            }
            EXPECT_NEAR(mean, *foretold[i].expected, within * error / std::sqrt(count) + 1e-9);
            if (foretold[i].name != "Agreement of all copies") { // its own spread is that of rare large squares
                EXPECT_NEAR(std::sqrt(square), error, 0.15 * error + 1e-9);
            }
        }
    }
}

TEST(Theory, CountsPicksAsTheServerSharesPlaces) {
    for (const auto model : {evolution::PopulationModel::Hybrid, evolution::PopulationModel::Generational,
                             evolution::PopulationModel::SteadyState}) {
        for (const std::uint32_t elite : {0u, 3u, 40u}) {
            for (const std::uint32_t wanted : {1u, 2u, 11u, 50u}) {
                Parameters parameters;
                parameters.population_model = model;
                parameters.elite_count = elite;
                parameters.replaced_count = 7;
                parameters.survivors = 0.45;
                const auto places = evolution::share_places(30, wanted, parameters);
                const Selection selection = selection_of(assignments_of(parameters), 30, wanted);
                const std::uint32_t picks = model == evolution::PopulationModel::Hybrid ? places.survivors
                                            : places.children > 0                       ? std::max(2u, places.children)
                                                                                        : 0;
                EXPECT_EQ(selection.picks, picks) << elite << " " << wanted;
                EXPECT_EQ(selection.pool, model == evolution::PopulationModel::Hybrid ? 30u : 14u);
                EXPECT_EQ(selection.overlapping, model == evolution::PopulationModel::SteadyState);
            }
        }
    }
}

// ---- closed forms of Blickle & Thiele 1996, which hold in large populations ---------------------------------------

constexpr std::uint32_t many = 100'000;

Selection large(Selection::Method method) {
    Selection selection;
    selection.method = method;
    selection.population = selection.picks = selection.pool = many;
    return selection;
}

TEST(Theory, TournamentsHaveTheIntensityAndLossOfTheClosedForms) {
    Selection selection = large(Selection::Method::Tournament);
    // Means of the greatest of t standard normal numbers.
    for (const auto& [size, intensity] : {std::pair{1u, 0.0},
                                          {2u, 1 / std::sqrt(std::numbers::pi)},
                                          {3u, 1.5 / std::sqrt(std::numbers::pi)},
                                          {5u, 1.16296447},
                                          {10u, 1.53875273}}) {
        selection.tournament_size = size;
        const auto copies = expect(selection, {}).copies;
        EXPECT_NEAR(normal_selection_intensity(copies), intensity, 1e-4);
        const double t = size;
        const double loss = size == 1 ? 0 : std::pow(t, -1 / (t - 1)) - std::pow(t, -t / (t - 1));
        EXPECT_NEAR(loss_of_diversity(copies), loss, 1e-4);
    }
}

TEST(Theory, TruncationHasTheIntensityAndLossOfTheClosedForms) {
    Selection selection = large(Selection::Method::Truncation);
    for (const auto& [share, intensity] : {std::pair{0.5, 0.79788456}, {0.1, 1.75498332}, {0.01, 2.66521422}}) {
        selection.pool = static_cast<std::uint32_t>(share * many);
        const auto copies = expect(selection, {}).copies;
        EXPECT_NEAR(normal_selection_intensity(copies), intensity, 1e-6);
        EXPECT_NEAR(loss_of_diversity(copies), 1 - share, 1e-9);
    }
}

TEST(Theory, RankingHasTheIntensityAndLossOfTheClosedForms) {
    Selection selection = large(Selection::Method::Roulette);
    selection.scaling = Selection::Scaling::LinearRanking;
    for (const double pressure : {1.0, 1.5, 2.0}) {
        selection.ranking_pressure = pressure;
        const auto copies = expect(selection, {}).copies;
        EXPECT_NEAR(normal_selection_intensity(copies), (pressure - 1) / std::sqrt(std::numbers::pi), 1e-4);
        EXPECT_NEAR(loss_of_diversity(copies), (pressure - 1) / 4, 1e-4);
    }
    // c^N = κ: loss (1 − ln((κ − 1)/(κ ln κ)))/ln κ − κ/(κ − 1), here as in their table for κ = 10^-9.
    selection.scaling = Selection::Scaling::ExponentialRanking;
    const double kappa = 1e-9, logarithm = std::log(kappa);
    selection.ranking_decay = std::pow(kappa, 1.0 / many);
    EXPECT_NEAR(loss_of_diversity(expect(selection, {}).copies),
                (1 - std::log((kappa - 1) / (kappa * logarithm))) / logarithm - kappa / (kappa - 1), 1e-3);
}

TEST(Theory, ProportionalSelectionHasTheIntensityOfTheSpread) {
    // The deviation divided by the mean.
    const std::vector<double> fitness{9, 7, 2, 2};
    Selection selection;
    selection.population = 4;
    selection.picks = 4;
    EXPECT_NEAR(selection_intensity(expect(selection, fitness).copies, fitness), std::sqrt(9.5) / 5, 1e-12);
}

TEST(Theory, IndependentPicksMissAsManyAsMotokiSays) {
    // Without pressure (1 − 1/n)^n of all are missed.
    Selection selection = large(Selection::Method::Tournament);
    selection.tournament_size = 1;
    const auto missed = expect(selection, {}).missed;
    EXPECT_NEAR(std::accumulate(missed.begin(), missed.end(), 0.0) / many, std::exp(-1.0), 1e-5);
}

// ---- takeover: Goldberg & Deb 1991 --------------------------------------------------------------------------------

TEST(Theory, TakeoverIsAsFastAsTheClosedForms) {
    Selection selection = large(Selection::Method::Tournament);
    const double n = many;
    for (const std::uint32_t size : {2u, 3u, 7u}) {
        selection.tournament_size = size;
        const double form = (std::log(n) + std::log(std::log(n))) / std::log(double(size));
        EXPECT_NEAR(takeover_generations(selection, {}).value(), form, 1) << size;
    }
    selection = large(Selection::Method::Truncation);
    selection.pool = many / 4;
    EXPECT_EQ(takeover_generations(selection, {}), std::ceil(std::log(n) / std::log(4.0)));

    selection = large(Selection::Method::StochasticUniversal);
    selection.scaling = Selection::Scaling::LinearRanking;
    selection.ranking_pressure = 2;
    EXPECT_NEAR(takeover_generations(selection, {}).value(), std::log2(n) + std::log2(std::log(n)), 1.5);

    // x^c on evenly spaced x: (n ln n − 1)/c.
    selection = {};
    selection.population = selection.picks = 1000;
    std::vector<double> fitness;
    for (std::uint32_t rank = 0; rank < 1000; ++rank) {
        fitness.push_back(1000 - rank);
    }
    EXPECT_NEAR(takeover_generations(selection, fitness).value(), 1000 * std::log(1000.0), 10);
}

TEST(Theory, NobodyTakesOverWhereNobodyIsPreferred) {
    Selection selection;
    selection.population = selection.picks = selection.pool = 50;
    const std::vector<double> alike(50, 3.0);
    EXPECT_EQ(takeover_generations(selection, std::vector<double>(50, 0.0)), std::nullopt);
    EXPECT_EQ(takeover_generations(selection, alike), 1u) << "all are copies of the fittest";
    selection.method = Selection::Method::Random;
    EXPECT_EQ(takeover_generations(selection, alike), std::nullopt);
    selection.method = Selection::Method::Tournament;
    selection.tournament_size = 1;
    EXPECT_EQ(takeover_generations(selection, alike), std::nullopt);
    selection.tournament_size = 2;
    selection.overlapping = true;
    EXPECT_EQ(takeover_generations(selection, alike), std::nullopt);
}

// ---- against what happened ----------------------------------------------------------------------------------------

TEST(Theory, TellsTheDeviationInStandardErrors) {
    Selection selection;
    selection.population = 4;
    selection.picks = 100;
    const std::vector<double> fitness{4, 3, 2, 1};
    const auto found = findings(selection, fitness, std::vector<std::uint32_t>{52, 25, 15, 8});
    ASSERT_EQ(found.front().name, "Copies of the fittest");
    EXPECT_DOUBLE_EQ(found.front().expected.value(), 40);
    EXPECT_NEAR(found.front().deviation().value(), 12 / std::sqrt(100 * 0.4 * 0.6), 1e-9);
    for (const Finding& finding : findings(selection, fitness, {})) {
        EXPECT_EQ(finding.happened, std::nullopt) << finding.name;
        EXPECT_EQ(finding.deviation(), std::nullopt);
        EXPECT_FALSE(finding.sentence.empty() || finding.source.empty());
    }
}

TEST(Theory, WhatCannotHappenIsInfinitelyFarAway) {
    Selection selection;
    selection.method = Selection::Method::Truncation;
    selection.population = 4;
    selection.picks = selection.pool = 2;
    const std::vector<double> fitness{4, 3, 2, 1};
    EXPECT_EQ(findings(selection, fitness, std::vector<std::uint32_t>{1, 1, 0, 0}).front().deviation(), 0);
    EXPECT_TRUE(
        std::isinf(findings(selection, fitness, std::vector<std::uint32_t>{2, 0, 0, 0}).front().deviation().value()));
}

TEST(Theory, HoldsAtTheEdgesOfFitness) {
    Selection selection;
    selection.population = selection.picks = 3;
    constexpr double huge = std::numeric_limits<double>::max();
    using testing::ElementsAre;
    EXPECT_THAT(expect(selection, std::vector<double>{huge, 0, -huge}).copies, ElementsAre(2, 1, 0));
    EXPECT_THAT(expect(selection, std::vector<double>{0, 0, 0}).copies, ElementsAre(1, 1, 1));
    selection.scaling = Selection::Scaling::Windowing;
    EXPECT_THAT(expect(selection, std::vector<double>{7, 7, 7}).copies, ElementsAre(1, 1, 1));
    EXPECT_THAT(expect(selection, std::vector<double>{9, 8, 7}).copies, ElementsAre(2, 1, 0));
    selection.picks = 0;
    EXPECT_TRUE(findings(selection, std::vector<double>{9, 8, 7}, {}).empty());
}

} // namespace
} // namespace evod::viewer
