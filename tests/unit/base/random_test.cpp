#include "server/base/random.h"

#include "tests/support/chi_square.h"

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

namespace evod::base {
namespace {

using support::alpha;

RandomStream stream(std::uint64_t seed, std::uint32_t entity = 0) {
    return RandomStream{RandomKey{Seed{seed}, Purpose::ScenarioTest, 0, 1}, entity};
}

struct Vector {
    r123::Philox4x32::ctr_type counter;
    r123::Philox4x32::key_type key;
    r123::Philox4x32::ctr_type result;
};

TEST(Philox, GivesThePublishedVectors) { // known-answer tests of Random123: philox4x32 with 10 rounds
    const Vector vectors[] = {
        {{{0, 0, 0, 0}}, {{0, 0}}, {{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}}},
        {{{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}},
         {{0xffffffff, 0xffffffff}},
         {{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}}},
        {{{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}},
         {{0xa4093822, 0x299f31d0}},
         {{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}}},
    };
    for (const Vector& v : vectors) {
        EXPECT_EQ(r123::Philox4x32{}(v.counter, v.key), v.result);
    }
}

TEST(RandomKey, EveryPartOfTheIdentityChangesTheDraws) {
    const auto draw = [](std::uint64_t seed, Purpose purpose, std::uint32_t island, std::uint64_t generation,
                         std::uint32_t entity, std::uint64_t tick, std::uint32_t block) {
        return RandomKey{Seed{seed}, purpose, island, generation}.words(entity, tick, block);
    };
    const auto reference = draw(1, Purpose::Behaviour, 2, 3, 4, 5, 6);
    EXPECT_EQ(reference, draw(1, Purpose::Behaviour, 2, 3, 4, 5, 6));
    EXPECT_NE(reference, draw(1ull << 32 | 1, Purpose::Behaviour, 2, 3, 4, 5, 6));
    EXPECT_NE(reference, draw(1, Purpose::Mutation, 2, 3, 4, 5, 6));
    EXPECT_NE(reference, draw(1, Purpose::Behaviour, 3, 3, 4, 5, 6));
    EXPECT_NE(reference, draw(1, Purpose::Behaviour, 2, 1ull << 32 | 3, 4, 5, 6));
    EXPECT_NE(reference, draw(1, Purpose::Behaviour, 2, 3, 5, 5, 6));
    EXPECT_NE(reference, draw(1, Purpose::Behaviour, 2, 3, 4, 1ull << 32 | 5, 6));
    EXPECT_NE(reference, draw(1, Purpose::Behaviour, 2, 3, 4, 5, 7));
}

TEST(RandomStream, BelowIsUniform) {
    RandomStream random = stream(11);
    std::vector<std::uint64_t> counts(7);
    for (int i = 0; i < 700'000; ++i) {
        ++counts[random.below(7)];
    }
    EXPECT_GT(support::p_value_of_equal_cells(counts), alpha);
}

TEST(RandomStream, BelowHasNoBiasForBoundsNearTheWordSize) {
    // With a bound of 3·2^30 a plain product would give every third value twice as often.
    RandomStream random = stream(12);
    std::vector<std::uint64_t> counts(3);
    for (int i = 0; i < 300'000; ++i) {
        ++counts[random.below(3u << 30) % 3];
    }
    EXPECT_GT(support::p_value_of_equal_cells(counts), alpha);
}

TEST(RandomStream, UniformFillsItsInterval) {
    RandomStream random = stream(13);
    std::vector<std::uint64_t> counts(100);
    for (int i = 0; i < 1'000'000; ++i) {
        const double u = random.uniform();
        ASSERT_GE(u, 0);
        ASSERT_LT(u, 1);
        ++counts[static_cast<std::size_t>(u * 100)];
    }
    EXPECT_GT(support::p_value_of_equal_cells(counts), alpha);
}

TEST(RandomStream, GaussianHasTheMomentsOfTheNormalLaw) {
    RandomStream random = stream(14);
    constexpr int n = 1'000'000;
    double sum = 0, squares = 0, fourths = 0;
    for (int i = 0; i < n; ++i) {
        const double x = random.gaussian();
        sum += x;
        squares += x * x;
        fourths += x * x * x * x;
    }
    // Five standard errors of each estimate: 1/√n, √2/√n, √96/√n.
    EXPECT_NEAR(sum / n, 0, 5e-3);
    EXPECT_NEAR(squares / n, 1, 7.1e-3);
    EXPECT_NEAR(fourths / n, 3, 4.9e-2);
}

TEST(RandomStream, ShuffleGivesEveryOrderEquallyOften) {
    std::map<std::vector<int>, std::uint64_t> orders;
    for (std::uint32_t i = 0; i < 240'000; ++i) {
        std::vector<int> items{0, 1, 2, 3};
        stream(15, i).shuffle(std::span{items});
        ++orders[items];
    }
    std::vector<std::uint64_t> counts;
    for (const auto& [order, count] : orders) {
        counts.push_back(count);
    }
    ASSERT_EQ(counts.size(), 24u);
    EXPECT_GT(support::p_value_of_equal_cells(counts), alpha);
}

TEST(Pair, IsPhilox2x32WithTenRounds) {
    // Known answers of the generator's authors for counter and key of all zeros, all ones, and digits of π.
    const auto out = [](std::uint32_t c0, std::uint32_t c1, std::uint32_t key) {
        const auto words = r123::Philox2x32{}({{c0, c1}}, {{key}});
        return std::array<std::uint32_t, 2>{words[0], words[1]};
    };
    EXPECT_EQ(out(0, 0, 0), (std::array<std::uint32_t, 2>{0xff1dae59, 0x6cd10df2}));
    EXPECT_EQ(out(0xffffffff, 0xffffffff, 0xffffffff), (std::array<std::uint32_t, 2>{0x2c3f628b, 0xab4fd7ad}));
    EXPECT_EQ(out(0x243f6a88, 0x85a308d3, 0x13198a2e), (std::array<std::uint32_t, 2>{0xdd7ce038, 0xf62a4c12}));
    const RandomKey key{Seed{5}, Purpose::Behaviour, 1, 2};
    for (std::uint32_t entity = 0; entity < 50; ++entity) {
        EXPECT_EQ(key.pair(entity, 9), out(entity, key.pair_counter(9), key.pair_key()));
    }
}

TEST(Pair, FillsCellsEquallyOverEntitiesAndTicks) {
    const RandomKey key{Seed{6}, Purpose::Behaviour, 1, 2};
    std::array<std::uint64_t, 256> first{}, second{};
    for (std::uint32_t entity = 0; entity < 500; ++entity) {
        for (std::uint32_t tick = 1; tick <= 200; ++tick) {
            const auto words = key.pair(entity, tick);
            ++first[words[0] >> 24];
            ++second[words[1] >> 24];
        }
    }
    EXPECT_GT(support::p_value_of_equal_cells(first), 1e-6);
    EXPECT_GT(support::p_value_of_equal_cells(second), 1e-6);
}

} // namespace
} // namespace evod::base
