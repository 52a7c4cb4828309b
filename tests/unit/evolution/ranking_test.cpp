#include "server/evolution/ranking.h"

#include "server/jobs/thread_pool.h"
#include "tests/unit/evolution/draws.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>

namespace evod::evolution {
namespace {

std::vector<std::uint32_t> best_first(std::span<const double> fitness) {
    Ranking ranking{fitness};
    const auto order = ranking.best_first();
    return {order.begin(), order.end()};
}

TEST(Ranking, LowerIndexIsTheBetterRankOfTies) {
    EXPECT_EQ(best_first(std::vector{1.0, 3.0, 3.0, 2.0, 3.0, 1.0}), (std::vector{1u, 2u, 4u, 3u, 0u, 5u}));
    EXPECT_EQ(best_first(std::vector{-0.0, 0.0, -0.0}), (std::vector{0u, 1u, 2u}));
    EXPECT_EQ(best_first(std::vector{7.0}), (std::vector{0u}));
    EXPECT_EQ(best_first(std::vector<double>{}), (std::vector<std::uint32_t>{}));
}

TEST(Ranking, OrdersAllMagnitudesAndSigns) {
    constexpr double huge = std::numeric_limits<double>::max(), tiny = std::numeric_limits<double>::denorm_min();
    EXPECT_EQ(best_first(std::vector{-huge, tiny, huge, -1.0, -tiny, 0.0, 1.0}),
              (std::vector{2u, 6u, 1u, 5u, 4u, 3u, 0u}));
}

RC_GTEST_PROP(Ranking, IsAStableSort, (const std::vector<double>& fitness)) {
    std::vector<std::uint32_t> expected(fitness.size());
    std::iota(expected.begin(), expected.end(), 0u);
    std::stable_sort(expected.begin(), expected.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return fitness[a] > fitness[b]; });
    RC_ASSERT(best_first(fitness) == expected);
}

TEST(Ranking, IsAStableSortOfManyWithTies) {
    base::RandomStream random = stream_of(121);
    std::vector<double> fitness(50'000);
    for (double& value : fitness) {
        value = (random.below(1000) - 500.0) * 0x1p-40;
    }
    std::vector<std::uint32_t> expected(fitness.size());
    std::iota(expected.begin(), expected.end(), 0u);
    std::stable_sort(expected.begin(), expected.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return fitness[a] > fitness[b]; });
    EXPECT_EQ(best_first(fitness), expected);
    for (const std::size_t threads : {2, 3, 8, 13}) {
        jobs::ThreadPool executor{threads};
        Ranking ranking{fitness, executor};
        EXPECT_TRUE(std::ranges::equal(ranking.best_first(), expected));
    }
}

TEST(Ranking, OrdersManyForAnyDistributionOfFitness) {
    base::RandomStream random = stream_of(122);
    constexpr double huge = std::numeric_limits<double>::max(), tiny = std::numeric_limits<double>::denorm_min();
    for (const double outlier : {0.0, 1e300, -huge, huge}) {
        for (const double unit : {tiny, 1e-300, 1.0, huge / 4}) {
            std::vector<double> fitness(3000);
            for (double& value : fitness) {
                value = (random.below(2000) - 1000.0) * 0x1p-10 * unit;
            }
            fitness[1234] = outlier;
            std::vector<std::uint32_t> expected(fitness.size());
            std::iota(expected.begin(), expected.end(), 0u);
            std::ranges::stable_sort(expected, std::greater{}, [&](std::uint32_t i) { return fitness[i]; });
            ASSERT_EQ(best_first(fitness), expected) << outlier << " among " << unit;
        }
    }
}

} // namespace
} // namespace evod::evolution
