#include "server/evolution/scaling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

namespace evod::evolution {
namespace {

std::vector<double> scaled(std::span<const double> fitness, FitnessScaling scaling, Parameters parameters = {}) {
    parameters.fitness_scaling = scaling;
    Ranking ranking{fitness};
    return scaled_fitness(ranking, parameters);
}

const std::vector<double> falling_fitness = {10, 9, 8, 7, 6, 5, 4, 3, 2, 1};

TEST(Scaling, NoneGivesTheFitness) {
    const std::vector fitness = {3.0, -1.0, 2.0};
    EXPECT_EQ(scaled(fitness, FitnessScaling::None), fitness);
}

TEST(Scaling, WindowingSubtractsTheLeast) {
    EXPECT_EQ(scaled(std::vector{3.0, -1.0, 2.0}, FitnessScaling::Windowing), (std::vector{4.0, 0.0, 3.0}));
    EXPECT_EQ(scaled(std::vector{5.0, 5.0}, FitnessScaling::Windowing), (std::vector{0.0, 0.0}));
}

TEST(Scaling, WindowingKeepsTheRatiosOfHugeFitness) {
    constexpr double huge = std::numeric_limits<double>::max();
    EXPECT_EQ(scaled(std::vector{huge, 0.0, -huge}, FitnessScaling::Windowing), (std::vector{huge, huge / 2, 0.0}));
}

TEST(Scaling, LinearRankingHasMeanOneAndBestPressure) {
    for (const double pressure : {1.0, 1.5, 2.0}) {
        Parameters parameters;
        parameters.ranking_pressure = pressure;
        const auto weights = scaled(falling_fitness, FitnessScaling::LinearRanking, parameters);
        EXPECT_DOUBLE_EQ(weights.front(), pressure);
        EXPECT_DOUBLE_EQ(weights.back(), 2 - pressure);
        EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 10, 1e-12);
        EXPECT_NEAR(weights[3] - weights[4], 2 * (pressure - 1) / 9, 1e-12); // equal steps from rank to rank
    }
    EXPECT_EQ(scaled(std::vector{4.0}, FitnessScaling::LinearRanking), std::vector{1.0});
}

TEST(Scaling, RankingPrefersTheLowerIndexOfTies) {
    Parameters parameters;
    parameters.ranking_decay = 0.5;
    EXPECT_EQ(scaled(std::vector{1.0, 7.0, 1.0, 1e300}, FitnessScaling::ExponentialRanking, parameters),
              (std::vector{0.25, 0.5, 0.125, 1.0}));
    parameters.ranking_pressure = 2;
    EXPECT_EQ(scaled(std::vector{5.0, 5.0, 5.0}, FitnessScaling::LinearRanking, parameters),
              (std::vector{2.0, 1.0, 0.0}));
}

TEST(Scaling, ExponentialRankingDecaysByAFactorPerRank) {
    Parameters parameters;
    parameters.ranking_decay = 0.9;
    const auto weights = scaled(falling_fitness, FitnessScaling::ExponentialRanking, parameters);
    for (int rank = 0; rank < 10; ++rank) {
        EXPECT_NEAR(weights[rank], std::pow(0.9, rank), 1e-15);
    }
}

TEST(Scaling, ExponentialRankingOfManyReachesZero) {
    Parameters parameters;
    parameters.ranking_decay = 0.01;
    std::vector<double> fitness(1000);
    std::iota(fitness.rbegin(), fitness.rend(), 0.0);
    const auto weights = scaled(fitness, FitnessScaling::ExponentialRanking, parameters);
    EXPECT_EQ(weights.front(), 1);
    EXPECT_EQ(weights.back(), 0); // its index is its rank
    fitness.resize(20'000);
    std::iota(fitness.rbegin(), fitness.rend(), 0.0);
    EXPECT_EQ(scaled(fitness, FitnessScaling::ExponentialRanking).back(), 0);
}

} // namespace
} // namespace evod::evolution
