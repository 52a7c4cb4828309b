// The predictions of theory against closed forms, and against many selections of the server.
#include "client/viewer/panels/breeding/theory.h"

#include "server/base/inline_executor.h"
#include "server/evolution/scaling.h"
#include "server/evolution/selection_law.h"
#include "server/evolution/wheel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

namespace evod::viewer {
namespace {

using evolution::FitnessScaling;
using evolution::Parameters;
using evolution::SelectionMethod;

/// Best first, with ties.
std::vector<double> tied_fitness(std::uint32_t population) {
    std::vector<double> fitness;
    for (std::uint32_t rank = 0; rank < population; ++rank) {
        fitness.push_back(5.0 + 3.0 * std::floor((population - rank) / 2.0));
    }
    return fitness;
}

/// A selection of the server: what the viewer knows of it, and the law that the server sends.
struct TheoryCase {
    const char* name = "";
    Parameters parameters{};
    std::uint32_t population = 20, picks = 20, pool = 20;

    Selection selection() const {
        evod::v1::Breeding breeding;
        breeding.set_pick_count(picks);
        const auto add = [&](const char* parameter) {
            breeding.add_parameters()->set_name(parameter);
            return breeding.mutable_parameters()->rbegin()->mutable_value();
        };
        constexpr const char* methods[] = {"roulette", "stochastic_universal", "tournament", "random", "truncation"};
        constexpr const char* scalings[] = {"none", "windowing", "linear_ranking", "exponential_ranking"};
        constexpr const char* models[] = {"hybrid", "generational", "steady_state"};
        add("selection")->set_choice(methods[static_cast<int>(parameters.selection)]);
        add("fitness_scaling")->set_choice(scalings[static_cast<int>(parameters.fitness_scaling)]);
        add("population_model")->set_choice(models[static_cast<int>(parameters.population_model)]);
        add("tournament_winners")->set_count(parameters.tournament_winners);
        add("mutation_chance")->set_real(0.5);
        return selection_of(breeding);
    }
    Expectation expectation(std::span<const double> fitness) const {
        evolution::Ranking ranking{fitness};
        const evolution::Wheel wheel{scaled_fitness(ranking, parameters)};
        const evolution::SelectionLaw law{population, {.wanted = picks, .pool = pool}, parameters};
        Expectation expectation;
        for (std::uint32_t rank = 0; rank < population; ++rank) {
            const evolution::CopiesLaw copies = law.copies(rank, wheel.share(rank));
            expectation.copies.push_back(copies.expected);
            expectation.standard_error.push_back(copies.standard_error);
            expectation.unpicked_chance.push_back(copies.unpicked_chance);
        }
        return expectation;
    }
    std::optional<std::uint32_t> takeover(std::span<const double> fitness) const {
        return takeover_generations(selection(), expectation(fitness).copies, fitness);
    }
};

TheoryCase theory_case(SelectionMethod method, std::uint32_t population) {
    TheoryCase made{.population = population, .picks = population, .pool = population};
    made.parameters.selection = method;
    return made;
}

// ---- against the server ----------------------------------------------------------------------------------------

std::vector<TheoryCase> theory_cases() {
    std::vector<TheoryCase> all;
    const auto add = [&](const char* name, SelectionMethod method) -> TheoryCase& {
        TheoryCase& added = all.emplace_back(theory_case(method, 20));
        added.name = name;
        return added;
    };
    add("roulette", SelectionMethod::Roulette);
    add("roulette, linear", SelectionMethod::Roulette).parameters.fitness_scaling = FitnessScaling::LinearRanking;
    add("universal", SelectionMethod::StochasticUniversal).picks = 33;
    add("tournament", SelectionMethod::Tournament);
    TheoryCase& several = add("tournament, several winners", SelectionMethod::Tournament);
    several.parameters.tournament_winners = 2;
    several.picks = 23;
    add("random", SelectionMethod::Random).picks = 33;
    TheoryCase& truncation = add("truncation", SelectionMethod::Truncation);
    truncation.pool = 7;
    truncation.picks = 18;
    return all;
}

TEST(Theory, PredictsTheMeanAndSpreadOfManySelections) {
    // Means of 4,000 breedings, each within 6 standard errors.
    constexpr std::uint32_t breedings = 4000;
    for (const TheoryCase& chosen : theory_cases()) {
        SCOPED_TRACE(chosen.name);
        const std::vector<double> fitness = tied_fitness(chosen.population);
        const Selection selection = chosen.selection();
        const Expectation expectation = chosen.expectation(fitness);
        const auto predicted = predictions(selection, expectation, fitness, {});
        std::vector<std::vector<double>> observed(predicted.size()); // by prediction, then breeding
        base::InlineExecutor executor;
        for (std::uint32_t breeding = 0; breeding < breedings; ++breeding) {
            evolution::Ranking ranking{fitness};
            std::vector<std::uint32_t> copies(chosen.population);
            for (const std::uint32_t organism :
                 evolution::select(ranking, {.wanted = chosen.picks, .pool = chosen.pool}, chosen.parameters,
                                   {base::Seed{8127}, base::Purpose::Selection, 0, breeding}, executor)) {
                ++copies[organism];
            }
            const auto now = predictions(selection, expectation, fitness, copies);
            ASSERT_EQ(now.size(), predicted.size());
            for (std::size_t i = 0; i < now.size(); ++i) {
                if (now[i].observed) {
                    observed[i].push_back(*now[i].observed);
                }
            }
        }
        for (std::size_t i = 0; i < predicted.size(); ++i) {
            if (!predicted[i].standard_error || observed[i].empty()) {
                continue;
            }
            SCOPED_TRACE(predicted[i].name);
            const double error = *predicted[i].standard_error;
            double mean = 0, square = 0;
            for (const double value : observed[i]) {
                mean += value / breedings;
                square += (value - *predicted[i].expected) * (value - *predicted[i].expected) / breedings;
            }
            EXPECT_NEAR(mean, *predicted[i].expected, 6 * error / std::sqrt(breedings) + 1e-9);
            if (predicted[i].name != "Agreement of all copies") { // rare large squares dominate its spread
                EXPECT_NEAR(std::sqrt(square), error, 0.15 * error + 1e-9);
            }
        }
    }
}

TEST(Theory, ReadsTheSelectionFromItsParameters) {
    TheoryCase chosen = theory_case(SelectionMethod::StochasticUniversal, 30);
    chosen.parameters.fitness_scaling = FitnessScaling::Windowing;
    chosen.parameters.population_model = evolution::PopulationModel::SteadyState;
    const Selection universal = chosen.selection();
    EXPECT_EQ(universal.method, Selection::Method::StochasticUniversal);
    EXPECT_EQ(universal.pressure, Selection::Pressure::WindowedFitness);
    EXPECT_TRUE(universal.overlapping);
    EXPECT_FALSE(universal.independent_picks);
    EXPECT_EQ(universal.picks, 30u);

    chosen = theory_case(SelectionMethod::Tournament, 30);
    EXPECT_EQ(chosen.selection().pressure, Selection::Pressure::Rank) << "a tournament ignores the scaling";
    EXPECT_TRUE(chosen.selection().independent_picks);
    EXPECT_FALSE(chosen.selection().overlapping);
    chosen.parameters.tournament_winners = 2;
    EXPECT_FALSE(chosen.selection().independent_picks);
    chosen.picks = 1;
    EXPECT_TRUE(chosen.selection().independent_picks) << "one pick depends on no other";
    EXPECT_EQ(theory_case(SelectionMethod::Roulette, 9).selection().pressure, Selection::Pressure::Fitness);
}

// ---- closed forms of Blickle & Thiele 1996, which hold in large populations ---------------------------------------

constexpr std::uint32_t many = 100'000;

std::vector<double> expected_copies(const TheoryCase& chosen) {
    return chosen.expectation(std::vector<double>(chosen.population)).copies;
}

TEST(Theory, TournamentsHaveTheClosedIntensityAndLoss) {
    TheoryCase tournament = theory_case(SelectionMethod::Tournament, many);
    // Means of the greatest of t standard normal numbers.
    for (const auto& [size, intensity] : {std::pair{1u, 0.0},
                                          {2u, 1 / std::sqrt(std::numbers::pi)},
                                          {3u, 1.5 / std::sqrt(std::numbers::pi)},
                                          {5u, 1.16296447},
                                          {10u, 1.53875273}}) {
        tournament.parameters.tournament_size = size;
        const auto copies = expected_copies(tournament);
        EXPECT_NEAR(normal_selection_intensity(copies), intensity, 1e-4);
        const double t = size;
        const double loss = size == 1 ? 0 : std::pow(t, -1 / (t - 1)) - std::pow(t, -t / (t - 1));
        EXPECT_NEAR(loss_of_diversity(copies), loss, 1e-4);
    }
}

TEST(Theory, TruncationHasTheClosedIntensityAndLoss) {
    TheoryCase truncation = theory_case(SelectionMethod::Truncation, many);
    for (const auto& [share, intensity] : {std::pair{0.5, 0.79788456}, {0.1, 1.75498332}, {0.01, 2.66521422}}) {
        truncation.pool = static_cast<std::uint32_t>(share * many);
        const auto copies = expected_copies(truncation);
        EXPECT_NEAR(normal_selection_intensity(copies), intensity, 1e-6);
        EXPECT_NEAR(loss_of_diversity(copies), 1 - share, 1e-9);
    }
}

TEST(Theory, RankingHasTheClosedIntensityAndLoss) {
    TheoryCase ranking = theory_case(SelectionMethod::Roulette, many);
    ranking.parameters.fitness_scaling = FitnessScaling::LinearRanking;
    for (const double pressure : {1.0, 1.5, 2.0}) {
        ranking.parameters.ranking_pressure = pressure;
        const auto copies = expected_copies(ranking);
        EXPECT_NEAR(normal_selection_intensity(copies), (pressure - 1) / std::sqrt(std::numbers::pi), 1e-4);
        EXPECT_NEAR(loss_of_diversity(copies), (pressure - 1) / 4, 1e-4);
    }
    // c^N = κ: loss (1 − ln((κ − 1)/(κ ln κ)))/ln κ − κ/(κ − 1), as in their table for κ = 10^-9.
    ranking.parameters.fitness_scaling = FitnessScaling::ExponentialRanking;
    const double kappa = 1e-9, logarithm = std::log(kappa);
    ranking.parameters.ranking_decay = std::pow(kappa, 1.0 / many);
    EXPECT_NEAR(loss_of_diversity(expected_copies(ranking)),
                (1 - std::log((kappa - 1) / (kappa * logarithm))) / logarithm - kappa / (kappa - 1), 1e-3);
}

TEST(Theory, ProportionalIntensityIsTheRelativeSpread) {
    // The standard deviation divided by the mean.
    const std::vector<double> fitness{9, 7, 2, 2};
    const auto copies = theory_case(SelectionMethod::Roulette, 4).expectation(fitness).copies;
    EXPECT_NEAR(selection_intensity(copies, fitness), std::sqrt(9.5) / 5, 1e-12);
}

TEST(Theory, IndependentPicksMissTheShareOfMotoki) {
    // Without selection pressure (1 − 1/n)^n of all are not picked.
    TheoryCase drift = theory_case(SelectionMethod::Tournament, many);
    drift.parameters.tournament_size = 1;
    const auto unpicked = drift.expectation(std::vector<double>(many)).unpicked_chance;
    EXPECT_NEAR(std::accumulate(unpicked.begin(), unpicked.end(), 0.0) / many, std::exp(-1.0), 1e-5);
}

// ---- takeover: Goldberg & Deb 1991 --------------------------------------------------------------------------------

TEST(Theory, TakeoverIsAsFastAsTheClosedForms) {
    const std::vector<double> equal(many);
    const double n = many;
    TheoryCase tournament = theory_case(SelectionMethod::Tournament, many);
    for (const std::uint32_t size : {2u, 3u, 7u}) {
        tournament.parameters.tournament_size = size;
        const double form = (std::log(n) + std::log(std::log(n))) / std::log(double(size));
        EXPECT_NEAR(tournament.takeover(equal).value(), form, 1) << size;
    }
    TheoryCase truncation = theory_case(SelectionMethod::Truncation, many);
    truncation.pool = many / 4;
    EXPECT_EQ(truncation.takeover(equal), std::ceil(std::log(n) / std::log(4.0)));

    TheoryCase universal = theory_case(SelectionMethod::StochasticUniversal, many);
    universal.parameters.fitness_scaling = FitnessScaling::LinearRanking;
    universal.parameters.ranking_pressure = 2;
    EXPECT_NEAR(universal.takeover(equal).value(), std::log2(n) + std::log2(std::log(n)), 1.5);

    // x^c on evenly spaced x: (n ln n − 1)/c.
    std::vector<double> fitness;
    for (std::uint32_t rank = 0; rank < 1000; ++rank) {
        fitness.push_back(1000 - rank);
    }
    EXPECT_NEAR(theory_case(SelectionMethod::Roulette, 1000).takeover(fitness).value(), 1000 * std::log(1000.0), 10);
}

TEST(Theory, NoTakeoverWithoutPreference) {
    const std::vector<double> equal(50, 3.0);
    EXPECT_EQ(theory_case(SelectionMethod::Roulette, 50).takeover(std::vector<double>(50, 0.0)), std::nullopt);
    EXPECT_EQ(theory_case(SelectionMethod::Roulette, 50).takeover(equal), 1u) << "all are copies of the fittest";
    EXPECT_EQ(theory_case(SelectionMethod::Random, 50).takeover(equal), std::nullopt);
    TheoryCase tournament = theory_case(SelectionMethod::Tournament, 50);
    tournament.parameters.tournament_size = 1;
    EXPECT_EQ(tournament.takeover(equal), std::nullopt);
    tournament.parameters.tournament_size = 2;
    EXPECT_TRUE(tournament.takeover(equal));
    tournament.parameters.population_model = evolution::PopulationModel::SteadyState;
    EXPECT_EQ(tournament.takeover(equal), std::nullopt);
}

// ---- against what was observed ---------------------------------------------------------------------------------

TEST(Theory, DeviationIsInStandardErrors) {
    TheoryCase roulette = theory_case(SelectionMethod::Roulette, 4);
    roulette.picks = 100;
    const std::vector<double> fitness{4, 3, 2, 1};
    const Expectation expectation = roulette.expectation(fitness);
    const auto made =
        predictions(roulette.selection(), expectation, fitness, std::vector<std::uint32_t>{52, 25, 15, 8});
    ASSERT_EQ(made.front().name, "Copies of the fittest");
    EXPECT_DOUBLE_EQ(made.front().expected.value(), 40);
    EXPECT_NEAR(made.front().deviation().value(), 12 / std::sqrt(100 * 0.4 * 0.6), 1e-9);
    for (const Prediction& prediction : predictions(roulette.selection(), expectation, fitness, {})) {
        EXPECT_EQ(prediction.observed, std::nullopt) << prediction.name;
        EXPECT_EQ(prediction.deviation(), std::nullopt);
        EXPECT_FALSE(prediction.sentence.empty() || prediction.source.empty());
    }
}

TEST(Theory, AnImpossibleNumberDeviatesInfinitely) {
    TheoryCase truncation = theory_case(SelectionMethod::Truncation, 4);
    truncation.picks = truncation.pool = 2;
    const std::vector<double> fitness{4, 3, 2, 1};
    const auto deviation_of = [&](const std::vector<std::uint32_t>& copies) {
        return predictions(truncation.selection(), truncation.expectation(fitness), fitness, copies)
            .front()
            .deviation();
    };
    EXPECT_EQ(deviation_of({1, 1, 0, 0}), 0);
    EXPECT_TRUE(std::isinf(deviation_of({2, 0, 0, 0}).value()));
}

TEST(Theory, WithoutPicksItPredictsNothing) {
    TheoryCase none = theory_case(SelectionMethod::Roulette, 3);
    none.picks = 0;
    const std::vector<double> fitness{9, 8, 7};
    EXPECT_TRUE(predictions(none.selection(), none.expectation(fitness), fitness, {}).empty());
}

} // namespace
} // namespace evod::viewer
