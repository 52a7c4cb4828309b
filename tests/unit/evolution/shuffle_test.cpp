#include "server/evolution/shuffle.h"

#include "server/evolution/distribution.h"
#include "server/jobs/thread_pool.h"
#include "tests/unit/evolution/draws.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace evod::evolution {
namespace {

std::vector<std::uint32_t> shuffled(std::uint32_t count, std::uint64_t seed, base::Executor& executor) {
    std::vector<std::uint32_t> items(count);
    std::iota(items.begin(), items.end(), 0u);
    base::RandomStream random = stream_of(seed);
    shuffle(items, random, executor);
    return items;
}

TEST(Distribute, IsAStableSortByBucketOnAnyThreadCount) {
    constexpr std::size_t count = 100'003, buckets = 37;
    base::RandomStream random = stream_of(261);
    std::vector<std::uint32_t> bucket_of(count);
    for (std::uint32_t& bucket : bucket_of) {
        bucket = random.below(buckets - 1); // the last stays empty
    }
    std::vector<std::uint32_t> expected(count);
    std::iota(expected.begin(), expected.end(), 0u);
    std::ranges::stable_sort(expected, {}, [&](std::uint32_t i) { return bucket_of[i]; });
    for (const std::size_t threads : {1, 2, 3, 8, 13}) {
        jobs::ThreadPool executor{threads};
        std::vector<std::uint32_t> order(count);
        const auto begins = distribute(
            count, buckets, executor, [&](std::size_t i) { return bucket_of[i]; },
            [&](std::size_t i, std::uint32_t place) { order[place] = static_cast<std::uint32_t>(i); });
        ASSERT_EQ(order, expected);
        ASSERT_EQ(begins.size(), buckets + 1);
        for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
            for (std::uint32_t place = begins[bucket]; place < begins[bucket + 1]; ++place) {
                ASSERT_EQ(bucket_of[order[place]], bucket);
            }
        }
        ASSERT_EQ(begins[buckets], count);
    }
    base::InlineExecutor executor;
    EXPECT_EQ(distribute(
                  0, 2, executor, [](std::size_t) { return 0u; }, [](std::size_t, std::uint32_t) {}),
              (std::vector<std::uint32_t>{0, 0, 0}));
}

TEST(Shuffle, OfManyKeepsAllItemsOnAnyThreadCount) {
    base::InlineExecutor inline_executor;
    const auto reference = shuffled(150'001, 262, inline_executor);
    for (const std::size_t threads : {2, 3, 8, 13}) {
        jobs::ThreadPool executor{threads};
        ASSERT_EQ(shuffled(150'001, 262, executor), reference);
    }
    auto sorted = reference;
    std::ranges::sort(sorted);
    for (std::uint32_t i = 0; i < sorted.size(); ++i) {
        ASSERT_EQ(sorted[i], i);
    }
}

TEST(Shuffle, OfManyMovesItemsToAnyPlace) {
    // Law: each twentieth of the items is distributed over the twentieths of the places at random. Chi-square of a
    // table with both margins fixed, 19 · 19 degrees of freedom.
    constexpr std::uint32_t count = 200'000, parts = 20;
    base::InlineExecutor executor;
    std::vector<std::uint64_t> table(parts * parts);
    const auto items = shuffled(count, 263, executor);
    for (std::uint32_t place = 0; place < count; ++place) {
        ++table[items[place] / (count / parts) * parts + place / (count / parts)];
    }
    const std::vector<double> expected(table.size(), static_cast<double>(count) / (parts * parts));
    EXPECT_GT(support::p_value(support::chi_square(table, expected), (parts - 1) * (parts - 1)), alpha);
}

TEST(Shuffle, OfManyMixesNeighbours) {
    // Law: of two neighbouring items, the second comes first with probability 1/2, and they stay neighbours with
    // probability 2/count. Chi-square over the exchanged pairs, 1 degree of freedom, and a bound on the number of pairs
    // that stay neighbours: 2 on average, more than 20 for fewer than 1e-13 of all seeds.
    constexpr std::uint32_t count = 100'000;
    base::InlineExecutor executor;
    const auto items = shuffled(count, 264, executor);
    std::vector<std::uint32_t> place_of(count);
    for (std::uint32_t place = 0; place < count; ++place) {
        place_of[items[place]] = place;
    }
    std::vector<std::uint64_t> sides(2);
    int together = 0;
    for (std::uint32_t item = 0; item + 1 < count; item += 2) {
        ++sides[place_of[item] < place_of[item + 1]];
        together += std::max(place_of[item], place_of[item + 1]) - std::min(place_of[item], place_of[item + 1]) == 1;
    }
    EXPECT_GT(support::p_value_of_equal_cells(sides), alpha);
    EXPECT_LE(together, 20);
}

} // namespace
} // namespace evod::evolution
