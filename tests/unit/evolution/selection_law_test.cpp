// The selection law against its closed forms and against many selections.
#include "server/evolution/selection_law.h"

#include "server/base/inline_executor.h"
#include "server/evolution/scaling.h"
#include "server/evolution/tournament.h"
#include "server/evolution/wheel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <string>
#include <vector>

namespace evod::evolution {
namespace {

/// Best first, with ties.
std::vector<double> tied_fitness(std::uint32_t population) {
    std::vector<double> fitness;
    for (std::uint32_t rank = 0; rank < population; ++rank) {
        fitness.push_back(5.0 + 3.0 * std::floor((population - rank) / 2.0));
    }
    return fitness;
}

struct LawCase {
    std::string name;
    Parameters parameters{};
    std::uint32_t population = 20, picks = 20, pool = 20;

    std::vector<CopiesLaw> laws(std::span<const double> fitness) const {
        Ranking ranking{fitness};
        const Wheel wheel{scaled_fitness(ranking, parameters)};
        const SelectionLaw law{population, {.wanted = picks, .pool = pool}, parameters};
        std::vector<CopiesLaw> laws;
        for (std::uint32_t rank = 0; rank < population; ++rank) {
            laws.push_back(law.copies(rank, wheel.share(rank)));
        }
        return laws;
    }
};

std::vector<LawCase> law_cases() {
    std::vector<LawCase> all;
    const auto add = [&](std::string name, SelectionMethod method) -> LawCase& {
        LawCase& added = all.emplace_back(LawCase{.name = std::move(name)});
        added.parameters.selection = method;
        return added;
    };
    add("roulette", SelectionMethod::Roulette);
    add("roulette, windowing", SelectionMethod::Roulette).parameters.fitness_scaling = FitnessScaling::Windowing;
    add("roulette, linear", SelectionMethod::Roulette).parameters.fitness_scaling = FitnessScaling::LinearRanking;
    add("universal, exponential", SelectionMethod::StochasticUniversal).parameters.fitness_scaling =
        FitnessScaling::ExponentialRanking;
    add("universal, more picks", SelectionMethod::StochasticUniversal).picks = 33;
    add("tournament", SelectionMethod::Tournament);
    for (const bool replacement : {true, false}) {
        const std::string kind = replacement ? "with replacement" : "without replacement";
        for (const std::uint32_t winners : {1u, 2u, 4u, 5u}) {
            LawCase& several = add(kind + ", winners " + std::to_string(winners), SelectionMethod::Tournament);
            several.parameters.tournament_size = 5;
            several.parameters.tournament_winners = winners;
            several.parameters.tournament_replacement = replacement;
            several.picks = 23; // the last tournament has surplus winners
        }
        LawCase& large = add(kind + ", large", SelectionMethod::Tournament);
        large.parameters.tournament_size = 90;
        large.parameters.tournament_winners = 3;
        large.parameters.tournament_replacement = replacement;
        large.population = 100;
    }
    add("random", SelectionMethod::Random).picks = 33;
    LawCase& truncation = add("truncation", SelectionMethod::Truncation);
    truncation.pool = 7;
    truncation.picks = 18;
    add("one organism", SelectionMethod::Tournament).population = 1;
    return all;
}

TEST(SelectionLaw, AgreesWithManySelections) {
    // Means of 20,000 breedings, each within 6 standard errors: a correct build fails in its some 2,000 comparisons
    // for less than one seed in 100,000.
    constexpr std::uint32_t breedings = 20'000;
    constexpr double within = 6;
    for (const LawCase& chosen : law_cases()) {
        SCOPED_TRACE(chosen.name);
        const std::vector<double> fitness = tied_fitness(chosen.population);
        const std::vector<CopiesLaw> laws = chosen.laws(fitness);
        std::vector<double> total(chosen.population), squares(chosen.population), unpicked(chosen.population);
        base::InlineExecutor executor;
        for (std::uint32_t breeding = 0; breeding < breedings; ++breeding) {
            Ranking ranking{fitness};
            std::vector<std::uint32_t> copies(chosen.population);
            for (const std::uint32_t organism :
                 select(ranking, {.wanted = chosen.picks, .pool = chosen.pool}, chosen.parameters,
                        {base::Seed{8127}, base::Purpose::Selection, 0, breeding}, executor)) {
                ++copies[organism];
            }
            for (std::uint32_t rank = 0; rank < chosen.population; ++rank) {
                total[rank] += copies[rank];
                squares[rank] += double(copies[rank]) * copies[rank];
                unpicked[rank] += copies[rank] == 0;
            }
        }
        double expected_picks = 0;
        for (std::uint32_t rank = 0; rank < chosen.population; ++rank) {
            const CopiesLaw& law = laws[rank];
            expected_picks += law.expected;
            const double mean = total[rank] / breedings, error = law.standard_error, chance = law.unpicked_chance;
            EXPECT_LE(std::abs(mean - law.expected), within * error / std::sqrt(breedings) + 1e-9) << rank;
            // A count as rare as this has a fourth moment of about its mean.
            const double variance = squares[rank] / breedings - mean * mean;
            const double spread = std::sqrt((error * error + 3 * std::pow(error, 4)) / breedings);
            EXPECT_NEAR(variance, error * error, within * spread + 1e-9) << rank;
            EXPECT_NEAR(unpicked[rank] / breedings, chance,
                        within * std::sqrt(chance * (1 - chance) / breedings) + 1e-9)
                << rank;
        }
        EXPECT_NEAR(expected_picks, chosen.picks, 1e-9);
    }
}

TEST(SelectionLaw, RouletteIsBinomial) {
    const SelectionLaw law{4, {.wanted = 100, .pool = 4}, [] {
                               Parameters parameters;
                               parameters.selection = SelectionMethod::Roulette;
                               return parameters;
                           }()};
    const CopiesLaw copies = law.copies(0, 0.4);
    EXPECT_DOUBLE_EQ(copies.expected, 40);
    EXPECT_DOUBLE_EQ(copies.standard_error, std::sqrt(100 * 0.4 * 0.6));
    EXPECT_DOUBLE_EQ(copies.unpicked_chance, std::pow(0.6, 100));
}

TEST(SelectionLaw, CertainCopiesHaveNoError) {
    Parameters parameters;
    parameters.selection = SelectionMethod::Truncation;
    const SelectionLaw law{4, {.wanted = 3, .pool = 2}, parameters};
    const double expected[] = {2, 1, 0, 0};
    for (std::uint32_t rank = 0; rank < 4; ++rank) {
        const CopiesLaw copies = law.copies(rank, 0);
        EXPECT_EQ(copies.expected, expected[rank]);
        EXPECT_EQ(copies.standard_error, 0);
        EXPECT_EQ(copies.unpicked_chance, expected[rank] == 0 ? 1 : 0);
    }
}

TEST(SelectionLaw, ExtremeFitnessKeepsTheLawFinite) {
    constexpr double huge = std::numeric_limits<double>::max();
    LawCase roulette{.name = "roulette", .population = 3, .picks = 3, .pool = 3};
    roulette.parameters.selection = SelectionMethod::Roulette;
    const auto expected = [&](std::vector<double> fitness) {
        std::vector<double> copies;
        for (const CopiesLaw& law : roulette.laws(fitness)) {
            EXPECT_TRUE(std::isfinite(law.standard_error));
            copies.push_back(law.expected);
        }
        return copies;
    };
    EXPECT_EQ(expected({huge, 0, -huge}), (std::vector<double>{2, 1, 0}));
    EXPECT_EQ(expected({0, 0, 0}), (std::vector<double>{1, 1, 1}));
    roulette.parameters.fitness_scaling = FitnessScaling::Windowing;
    EXPECT_EQ(expected({7, 7, 7}), (std::vector<double>{1, 1, 1}));
    EXPECT_EQ(expected({9, 8, 7}), (std::vector<double>{2, 1, 0}));
}

TEST(WinsOfRank, SeveralWinnersAreExactInASmallTournament) {
    // Two contestants of three organisms, both win: the number of times an organism is drawn is binomial.
    for (std::uint32_t rank = 0; rank < 3; ++rank) {
        const WinsLaw wins = wins_of_rank(rank, 3, {.size = 2, .winners = 2, .replacement = true});
        EXPECT_NEAR(wins.mean, 2.0 / 3, 1e-12);
        EXPECT_NEAR(wins.mean_square, 2.0 / 9 * 2 + 4.0 / 9, 1e-12);
        EXPECT_NEAR(wins.none_chance, 4.0 / 9, 1e-12);
    }
    // Three contestants of two organisms, two win. The fitter one is drawn 0 to 3 times with chances 1, 3, 3, 1 of 8.
    const WinsLaw fitter = wins_of_rank(0, 2, {.size = 3, .winners = 2, .replacement = true});
    EXPECT_NEAR(fitter.mean, (3 + 2 * 4) / 8.0, 1e-12);
    EXPECT_NEAR(fitter.mean_square, (3 + 4 * 4) / 8.0, 1e-12);
    EXPECT_NEAR(fitter.none_chance, 1 / 8.0, 1e-12);
    const WinsLaw weaker = wins_of_rank(1, 2, {.size = 3, .winners = 2, .replacement = true});
    EXPECT_NEAR(weaker.mean, (3 + 2 * 1) / 8.0, 1e-12);
    EXPECT_NEAR(weaker.none_chance, 4 / 8.0, 1e-12);
}

} // namespace
} // namespace evod::evolution
