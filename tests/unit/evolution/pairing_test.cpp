#include "server/evolution/pairing.h"

#include "tests/unit/evolution/draws.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

namespace evod::evolution {
namespace {

std::vector<std::uint32_t> numbered(std::uint32_t count) {
    std::vector<std::uint32_t> parents(count);
    std::iota(parents.begin(), parents.end(), 0u);
    return parents;
}

std::vector<Parents> pair_up(std::span<const std::uint32_t> parents, std::uint32_t pair_count,
                             const base::RandomKey& key) {
    base::InlineExecutor executor;
    return evolution::pair_up(parents, pair_count, key, executor);
}

TEST(Pairing, EveryParentMatesBeforeAnyMatesTwice) {
    for (std::uint32_t count = 2; count <= 9; ++count) {
        const std::uint32_t round = (count + 1) / 2;
        const auto pairs = pair_up(numbered(count), 3 * round, key_of(171));
        ASSERT_EQ(pairs.size(), 3 * round);
        for (std::uint32_t first = 0; first < pairs.size(); first += round) {
            std::set<std::uint32_t> met;
            for (std::uint32_t i = first; i < first + count / 2; ++i) {
                EXPECT_TRUE(met.insert(pairs[i].first).second);
                EXPECT_TRUE(met.insert(pairs[i].second).second);
            }
            if (count % 2 == 1) { // the last parent, and a mate that has already mated in this round
                EXPECT_FALSE(met.contains(pairs[first + round - 1].first));
                EXPECT_TRUE(met.contains(pairs[first + round - 1].second));
                met.insert(pairs[first + round - 1].first);
            }
            EXPECT_EQ(met.size(), count);
        }
    }
}

TEST(Pairing, EveryMatchingIsEquallyLikely) {
    // Law: 3 matchings of 4 parents. Chi-square, 2 degrees of freedom; the mate of parent 0 determines the matching.
    std::vector<std::uint64_t> counts(3);
    for (std::uint64_t seed = 0; seed < 100'000; ++seed) {
        for (const Parents& pair : pair_up(numbered(4), 2, key_of(1'000'000 + seed))) {
            if (std::min(pair.first, pair.second) == 0) {
                ++counts[std::max(pair.first, pair.second) - 1];
            }
        }
    }
    EXPECT_GT(support::p_value_of_equal_cells(counts), alpha);
}

TEST(Pairing, TheOddOneAndItsMateAreUniform) {
    // Law: 5 · 4 ordered pairs (last parent, mate) of 5 parents. Chi-square, 19 degrees of freedom.
    std::vector<std::uint64_t> counts(20);
    for (std::uint64_t seed = 0; seed < 100'000; ++seed) {
        const Parents pair = pair_up(numbered(5), 3, key_of(2'000'000 + seed)).back();
        ASSERT_NE(pair.first, pair.second);
        ++counts[pair.first * 4 + pair.second - (pair.second > pair.first)];
    }
    EXPECT_GT(support::p_value_of_equal_cells(counts), alpha);
}

TEST(Pairing, ASingleParentMatesWithItself) {
    const std::uint32_t lone[] = {7};
    EXPECT_EQ(pair_up(lone, 3, key_of(172)), (std::vector<Parents>{{7, 7}, {7, 7}, {7, 7}}));
}

TEST(Pairing, EachRoundIsShuffledAgain) {
    const auto pairs = pair_up(numbered(100), 100, key_of(173));
    EXPECT_NE(std::vector(pairs.begin(), pairs.begin() + 50), std::vector(pairs.begin() + 50, pairs.end()));
}

TEST(Pairing, FewerPairsAreTheFirstOfMore) {
    const auto many = pair_up(numbered(7), 11, key_of(174));
    for (std::uint32_t count = 0; count <= 11; ++count) {
        EXPECT_EQ(pair_up(numbered(7), count, key_of(174)), std::vector(many.begin(), many.begin() + count));
    }
    EXPECT_TRUE(pair_up({}, 0, key_of(174)).empty());
}

} // namespace
} // namespace evod::evolution
