#include "server/evolution/fitness_shuffle.h"

#include "server/jobs/thread_pool.h"
#include "tests/unit/evolution/draws.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace evod::evolution {
namespace {

/// 0, 1, 2, … after the shuffle: whose fitness each organism received.
std::vector<double> dealt(std::size_t count, const BreedingKey& key, base::Executor& executor) {
    std::vector<double> fitness(count);
    std::iota(fitness.begin(), fitness.end(), 0.0);
    shuffle_fitness(fitness, key, executor);
    return fitness;
}

TEST(FitnessShuffle, MakesEveryOrderEquallyLikely) {
    // Law: each of the 24 orders of four values has probability 1/24, over generations and islands. Chi-square, 23
    // degrees of freedom.
    base::InlineExecutor executor;
    for (const bool by_island : {false, true}) {
        std::vector<std::vector<double>> orders;
        std::vector<double> order{0, 1, 2, 3};
        do {
            orders.push_back(order);
        } while (std::ranges::next_permutation(order).found);
        std::vector<std::uint64_t> counts(orders.size());
        for (std::uint32_t i = 0; i < 24'000; ++i) {
            const BreedingKey key{
                .seed = base::Seed{271}, .island = by_island ? i : 3, .generation = by_island ? 5 : i + 1u};
            ++counts[static_cast<std::size_t>(std::ranges::find(orders, dealt(4, key, executor)) - orders.begin())];
        }
        EXPECT_GT(support::p_value_of_equal_cells(counts), alpha);
    }
}

TEST(FitnessShuffle, RemovesEveryCorrelation) {
    // Law: Spearman's rank correlation of a random order of n has mean 0 and variance 1/(n − 1), and is near normal for
    // n = 20,000. More than 6 standard deviations occur for fewer than 2e-9 of all seeds.
    constexpr std::size_t count = 20'000;
    base::InlineExecutor executor;
    const auto order = dealt(count, {.seed = base::Seed{272}, .island = 0, .generation = 1}, executor);
    const double mean = (count - 1) / 2.0;
    double covariance = 0, variance = 0;
    for (std::size_t i = 0; i < count; ++i) {
        covariance += (static_cast<double>(i) - mean) * (order[i] - mean);
        variance += (static_cast<double>(i) - mean) * (static_cast<double>(i) - mean);
    }
    EXPECT_LT(std::abs(covariance / variance) * std::sqrt(count - 1.0), 6);
}

TEST(FitnessShuffle, KeepsAllValuesOnAnyThreadCount) {
    base::InlineExecutor one;
    const BreedingKey key{.seed = base::Seed{273}, .island = 2, .generation = 9};
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{150'001}}) {
        const auto reference = dealt(count, key, one);
        auto sorted = reference;
        std::ranges::sort(sorted);
        for (std::size_t i = 0; i < count; ++i) {
            ASSERT_EQ(sorted[i], static_cast<double>(i));
        }
        jobs::ThreadPool many{5};
        ASSERT_EQ(dealt(count, key, many), reference);
    }
}

TEST(FitnessShuffle, DependsOnSeedIslandAndGeneration) {
    base::InlineExecutor executor;
    const auto reference = dealt(50, {.seed = base::Seed{274}, .island = 0, .generation = 1}, executor);
    EXPECT_EQ(dealt(50, {.seed = base::Seed{274}, .island = 0, .generation = 1}, executor), reference);
    EXPECT_NE(dealt(50, {.seed = base::Seed{275}, .island = 0, .generation = 1}, executor), reference);
    EXPECT_NE(dealt(50, {.seed = base::Seed{274}, .island = 1, .generation = 1}, executor), reference);
    EXPECT_NE(dealt(50, {.seed = base::Seed{274}, .island = 0, .generation = 2}, executor), reference);
}

} // namespace
} // namespace evod::evolution
