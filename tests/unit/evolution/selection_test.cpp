#include "server/evolution/selection.h"

#include "server/evolution/scaling.h"
#include "tests/unit/evolution/draws.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace evod::evolution {
namespace {

std::vector<std::uint32_t> spin_universal(const Wheel& wheel, std::uint32_t wanted, base::RandomStream& random) {
    base::InlineExecutor executor;
    return evolution::spin_universal(wheel, wanted, random, executor);
}

std::vector<std::uint32_t> draw_unique(std::uint32_t population, std::uint32_t wanted, base::RandomStream& random) {
    base::InlineExecutor executor;
    return evolution::draw_unique(population, wanted, random, executor);
}

const std::vector<double> ten_to_one = {10, 9, 8, 7, 6, 5, 4, 3, 2, 1};
constexpr double huge = std::numeric_limits<double>::max();
constexpr double tiny = std::numeric_limits<double>::denorm_min();

std::vector<std::uint64_t> spins(const std::vector<double>& weights, std::uint32_t count, std::uint64_t seed) {
    base::InlineExecutor executor;
    return count_each(spin_roulette(Wheel{weights}, count, key_of(seed), executor), weights.size());
}

std::vector<std::uint64_t> picks(const std::vector<double>& fitness, const Parameters& parameters, std::uint32_t count,
                                 std::uint64_t seed) {
    base::InlineExecutor executor;
    Ranking ranking{fitness};
    return count_each(select(ranking, {.wanted = count, .pool = 1}, parameters, key_of(seed), executor),
                      fitness.size());
}

TEST(Roulette, PicksInProportionToFitness) {
    // Law: fitness / 55. Chi-square over 10 organisms, 9 degrees of freedom.
    std::vector<double> law;
    for (const double fitness : ten_to_one) {
        law.push_back(fitness / 55);
    }
    EXPECT_GT(p_value_of_law(spins(ten_to_one, 1'000'000, 131), law), alpha);
}

TEST(Roulette, SpinsDoNotDependOnEachOther) {
    // Law: p_i p_j for two spins in a row. Chi-square over 100 pairs, 99 degrees of freedom.
    base::InlineExecutor executor;
    const auto picked = spin_roulette(Wheel{ten_to_one}, 1'000'000, key_of(132), executor);
    std::vector<std::uint64_t> counts(100);
    for (std::size_t i = 0; i + 1 < picked.size(); i += 2) {
        ++counts[picked[i] * 10 + picked[i + 1]];
    }
    std::vector<double> law;
    for (const double first : ten_to_one) {
        for (const double second : ten_to_one) {
            law.push_back(first * second / 55 / 55);
        }
    }
    EXPECT_GT(p_value_of_law(counts, law), alpha);
}

TEST(Roulette, NegativeWeightsAreShiftedByTheLeast) {
    // Law: (fitness + 3) / 9 for −3, 0, 3. Chi-square, 1 degree of freedom; the worst is never picked.
    EXPECT_GT(p_value_of_law(spins({-3, 0, 3}, 300'000, 133), std::vector{0.0, 1 / 3.0, 2 / 3.0}), alpha);
}

TEST(Roulette, AllZeroWeightsAndEqualNegativeOnesAreUniform) {
    // Law: 1/4 each. Chi-square, 3 degrees of freedom.
    EXPECT_GT(support::p_value_of_equal_cells(spins({0, 0, 0, 0}, 300'000, 134)), alpha);
    EXPECT_GT(support::p_value_of_equal_cells(spins({-5, -5, -5, -5}, 300'000, 135)), alpha);
    EXPECT_GT(support::p_value_of_equal_cells(spins({-huge, -huge, -huge, -huge}, 300'000, 136)), alpha);
}

TEST(Roulette, NeverPicksAWeightOfZero) {
    const auto counts = spins({0, 1, 0, 0, 2, 0}, 100'000, 137);
    EXPECT_EQ(counts[0] + counts[2] + counts[3] + counts[5], 0u);
    EXPECT_EQ(spins({0, 0, 0, tiny}, 1000, 138)[3], 1000u);
}

TEST(Roulette, HugeAndTinyWeightsKeepTheirRatios) {
    // Law: 1/4, 1/4, 1/2. Chi-square, 2 degrees of freedom.
    const std::vector<double> law = {0.25, 0.25, 0.5};
    EXPECT_GT(p_value_of_law(spins({huge / 2, huge / 2, huge}, 300'000, 139), law), alpha);
    EXPECT_GT(p_value_of_law(spins({tiny, tiny, 2 * tiny}, 300'000, 140), law), alpha);
    // Shifted by −huge, the weights are 0, 1 and 2 times huge.
    EXPECT_GT(p_value_of_law(spins({-huge, 0, huge}, 300'000, 141), std::vector{0.0, 1 / 3.0, 2 / 3.0}), alpha);
}

TEST(Roulette, PicksInProportionAmongVeryUnequalWeights) {
    // Law: weight / sum, 2,000 organisms in 8 groups whose weights differ by a factor of 8. Chi-square, 7 degrees of
    // freedom.
    std::vector<double> weights(2000), law(8);
    double sum = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        weights[i] = std::ldexp(1.0, 3 * static_cast<int>(i % 8));
        law[i % 8] += weights[i];
        sum += weights[i];
    }
    for (double& share : law) {
        share /= sum;
    }
    const auto each = spins(weights, 20'000'000, 142);
    std::vector<std::uint64_t> groups(8);
    for (std::size_t i = 0; i < each.size(); ++i) {
        groups[i % 8] += each[i];
    }
    EXPECT_GT(p_value_of_law(groups, law), alpha);
}

TEST(Wheel, SlotsEndAtTheCumulatedWeights) {
    const Wheel wheel{{1, 0, 3}};
    EXPECT_EQ(wheel.share(0), 0.25);
    EXPECT_EQ(wheel.share(1), 0);
    EXPECT_EQ(wheel.share(2), 0.75);
    EXPECT_EQ(wheel.at(0), 0u);
    EXPECT_EQ(wheel.at(0.25 - 0x1p-53), 0u);
    EXPECT_EQ(wheel.at(0.25), 2u);
    EXPECT_EQ(wheel.at(1 - 0x1p-53), 2u);
}

TEST(Wheel, TheGuideFindsWhatABinarySearchFinds) {
    base::RandomStream random = stream_of(143);
    std::vector<double> weights(3001);
    for (double& weight : weights) {
        weight = random.chance(0.5) ? 0 : std::ldexp(random.uniform(), static_cast<int>(random.below(60)));
    }
    const Wheel wheel{weights};
    const auto ends = wheel.slot_ends();
    for (int i = 0; i < 200'000; ++i) {
        const double turns = i % 2 == 0 ? random.uniform() : random.below(3001) / 3001.0;
        const auto expected = std::upper_bound(ends.begin(), ends.end(), turns * ends.back()) - ends.begin();
        ASSERT_EQ(wheel.at(turns), expected) << turns;
    }
}

TEST(Wheel, TheGuideIsRightAtRoundedSlotEnds) {
    for (const double weight : {0.1, 1.0, 3.0}) {
        for (std::size_t population = 1; population <= 200; ++population) {
            const Wheel wheel{std::vector<double>(population, weight)};
            const auto ends = wheel.slot_ends();
            for (std::size_t i = 1; i < population; ++i) {
                const double edge = static_cast<double>(i) / static_cast<double>(population);
                for (const double turns : {std::nextafter(edge, 0.0), edge, std::nextafter(edge, 1.0)}) {
                    const auto expected =
                        std::upper_bound(ends.begin(), ends.end(), turns * ends.back()) - ends.begin();
                    ASSERT_EQ(wheel.at(turns), expected) << turns;
                }
            }
        }
    }
}

TEST(StochasticUniversal, CopiesAreTheRoundedExpectationInEverySpin) {
    const Wheel wheel{ten_to_one};
    for (const std::uint32_t wanted : {1u, 3u, 10u, 55u, 100u}) {
        for (std::uint32_t spin = 0; spin < 2000; ++spin) {
            base::RandomStream random = stream_of(144, spin);
            const auto counts = count_each(spin_universal(wheel, wanted, random), 10);
            for (std::size_t i = 0; i < 10; ++i) {
                const double expected = wanted * ten_to_one[i] / 55;
                ASSERT_GE(static_cast<double>(counts[i]), std::floor(expected));
                ASSERT_LE(static_cast<double>(counts[i]), std::ceil(expected));
            }
        }
    }
}

TEST(StochasticUniversal, CopiesHaveTheExpectedMean) {
    // Law: an organism gets an extra copy with probability equal to the fractional part of 10 p. Chi-square, 1 degree
    // of freedom for each of the 10 organisms.
    const Wheel wheel{ten_to_one};
    constexpr std::uint32_t spin_count = 100'000;
    std::vector<std::uint64_t> copies(10);
    for (std::uint32_t spin = 0; spin < spin_count; ++spin) {
        base::RandomStream random = stream_of(145, spin);
        for (const std::uint32_t organism : spin_universal(wheel, 10, random)) {
            ++copies[organism];
        }
    }
    for (std::size_t i = 0; i < 10; ++i) {
        const double expected = 10 * ten_to_one[i] / 55, whole = std::floor(expected), fraction = expected - whole;
        const std::uint64_t extra = copies[i] - static_cast<std::uint64_t>(whole) * spin_count;
        EXPECT_GT(p_value_of_law(std::vector{spin_count - extra, extra}, std::vector{1 - fraction, fraction}), alpha);
    }
}

TEST(StochasticUniversal, TheOrderOfThePicksIsRandom) {
    // Law: with weights 1 and 1 and two pointers, each order with chance 1/2. Chi-square, 1 degree of freedom.
    const Wheel wheel{{1, 1}};
    std::vector<std::uint64_t> first(2);
    for (std::uint32_t spin = 0; spin < 100'000; ++spin) {
        base::RandomStream random = stream_of(146, spin);
        ++first[spin_universal(wheel, 2, random)[0]];
    }
    EXPECT_GT(support::p_value_of_equal_cells(first), alpha);
}

TEST(RandomSelection, PicksEverySetAndOrderEquallyOften) {
    // Law: 5 · 4 · 3 = 60 ordered choices of 3 from 5. Chi-square, 59 degrees of freedom.
    std::vector<std::uint64_t> counts(125);
    for (std::uint32_t i = 0; i < 200'000; ++i) {
        base::RandomStream random = stream_of(147, i);
        const auto picked = draw_unique(5, 3, random);
        ++counts[picked[0] * 25 + picked[1] * 5 + picked[2]];
    }
    std::vector<double> law(125);
    for (std::uint32_t a = 0; a < 5; ++a) {
        for (std::uint32_t b = 0; b < 5; ++b) {
            for (std::uint32_t c = 0; c < 5; ++c) {
                law[a * 25 + b * 5 + c] = a != b && b != c && a != c ? 1 / 60.0 : 0;
            }
        }
    }
    EXPECT_GT(p_value_of_law(counts, law), alpha);
}

TEST(RandomSelection, PicksAllBeforeAnyTwice) {
    base::RandomStream random = stream_of(148);
    const auto picked = draw_unique(7, 7 + 7 + 3, random);
    ASSERT_EQ(picked.size(), 17u);
    EXPECT_EQ(std::set<std::uint32_t>(picked.begin(), picked.begin() + 7).size(), 7u);
    EXPECT_EQ(std::set<std::uint32_t>(picked.begin() + 7, picked.begin() + 14).size(), 7u);
    EXPECT_EQ(std::set<std::uint32_t>(picked.begin() + 14, picked.end()).size(), 3u);
    EXPECT_NE(std::vector(picked.begin(), picked.begin() + 7), std::vector(picked.begin() + 7, picked.begin() + 14));
    EXPECT_TRUE(draw_unique(0, 3, random).empty());
}

TEST(Truncation, PicksExactlyTheBestInOrderOfRank) {
    const std::vector<double> fitness = {3, 9, 1, 9, 5};
    Ranking ranking{fitness};
    EXPECT_EQ(take_best(ranking, 5, 3), (std::vector{1u, 3u, 4u}));
    EXPECT_EQ(take_best(ranking, 2, 5), (std::vector{1u, 3u, 1u, 3u, 1u}));
    EXPECT_EQ(take_best(ranking, 5, 7), (std::vector{1u, 3u, 4u, 0u, 2u, 1u, 3u}));
}

TEST(Select, RouletteUnderLinearRankingFollowsTheRanks) {
    // Law: (pressure − 2(pressure − 1) rank / 9) / 10 for any fitness. Chi-square, 9 degrees of freedom.
    Parameters parameters;
    parameters.fitness_scaling = FitnessScaling::LinearRanking;
    parameters.ranking_pressure = 1.8;
    const std::vector<double> fitness = {1e300, 5, 4, 3, 2, 1, 0, -1, -2, -1e300};
    std::vector<double> law(10);
    for (std::uint32_t rank = 0; rank < 10; ++rank) {
        law[rank] = (1.8 - 1.6 * rank / 9) / 10;
    }
    EXPECT_GT(p_value_of_law(picks(fitness, parameters, 1'000'000, 149), law), alpha);
}

TEST(Select, RouletteUnderExponentialRankingFollowsTheRanks) {
    // Law: decay^rank (1 − decay) / (1 − decay^10). Chi-square, 9 degrees of freedom.
    Parameters parameters;
    parameters.fitness_scaling = FitnessScaling::ExponentialRanking;
    parameters.ranking_decay = 0.8;
    std::vector<double> law(10);
    for (int rank = 0; rank < 10; ++rank) {
        law[rank] = std::pow(0.8, rank) * 0.2 / (1 - std::pow(0.8, 10));
    }
    EXPECT_GT(p_value_of_law(picks(ten_to_one, parameters, 1'000'000, 150), law), alpha);
}

TEST(Select, RouletteUnderWindowingNeverPicksTheWorst) {
    // Law: (fitness − 1) / 45. Chi-square, 8 degrees of freedom.
    Parameters parameters;
    parameters.fitness_scaling = FitnessScaling::Windowing;
    std::vector<double> law;
    for (const double fitness : ten_to_one) {
        law.push_back((fitness - 1) / 45);
    }
    EXPECT_GT(p_value_of_law(picks(ten_to_one, parameters, 1'000'000, 151), law), alpha);
}

TEST(Select, ScalingDoesNotChangeTournamentAndTruncation) {
    base::InlineExecutor executor;
    std::vector<double> fitness(300); // with this decay the lower half has weight 0
    for (std::size_t i = 0; i < fitness.size(); ++i) {
        fitness[i] = static_cast<double>(i);
    }
    for (const SelectionMethod method : {SelectionMethod::Tournament, SelectionMethod::Truncation}) {
        Parameters plain, scaled;
        plain.selection = scaled.selection = method;
        scaled.fitness_scaling = FitnessScaling::ExponentialRanking;
        scaled.ranking_decay = 0.01;
        Ranking ranking{fitness};
        EXPECT_EQ(select(ranking, {.wanted = 300, .pool = 300}, plain, key_of(152), executor),
                  select(ranking, {.wanted = 300, .pool = 300}, scaled, key_of(152), executor));
    }
}

TEST(Select, EveryMethodPicksAsManyAsWanted) {
    base::InlineExecutor executor;
    for (const SelectionMethod method :
         {SelectionMethod::Roulette, SelectionMethod::StochasticUniversal, SelectionMethod::Tournament,
          SelectionMethod::Random, SelectionMethod::Truncation}) {
        Parameters parameters;
        parameters.selection = method;
        for (const std::size_t population : {1u, 2u, 3u, 10u}) {
            const std::vector<double> fitness(population, 1.0);
            for (const std::uint32_t wanted : {0u, 1u, 2u, 7u, 30u}) {
                Ranking ranking{fitness};
                const auto picked = select(ranking, {.wanted = wanted, .pool = 1}, parameters, key_of(153), executor);
                ASSERT_EQ(picked.size(), wanted);
                for (const std::uint32_t organism : picked) {
                    ASSERT_LT(organism, population);
                }
            }
        }
    }
}

} // namespace
} // namespace evod::evolution
