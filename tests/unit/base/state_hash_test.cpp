#include "server/base/state_hash.h"

#include "server/base/random.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <set>
#include <utility>

namespace evod::base {
namespace {

StateHash entity(std::uint32_t kind, std::uint64_t id, float x) {
    return EntityHash{kind, id}.add(x, 0.0f).finish();
}

TEST(StateHash, DoesNotDependOnTheOrderOfEntities) {
    const StateHash forward = entity(1, 1, 10) + entity(1, 2, 20) + entity(2, 1, 30);
    const StateHash backward = entity(2, 1, 30) + entity(1, 2, 20) + entity(1, 1, 10);
    EXPECT_EQ(forward, backward);
}

TEST(StateHash, DependsOnWhichEntityHasWhichFields) {
    EXPECT_NE(entity(1, 1, 10) + entity(1, 2, 20), entity(1, 1, 20) + entity(1, 2, 10));
    EXPECT_NE(entity(1, 1, 10), entity(2, 1, 10));
    EXPECT_NE(entity(1, 1, 0.0f), entity(1, 1, -0.0f));
}

TEST(StateHash, AnEntityCanBeSubtracted) {
    StateHash hash = entity(1, 1, 10) + entity(1, 2, 20);
    hash -= entity(1, 2, 20);
    EXPECT_EQ(hash, entity(1, 1, 10));
}

TEST(StateHash, AMillionEntitiesHaveDifferentWords) {
    std::set<std::pair<std::uint64_t, std::uint64_t>> seen;
    for (std::uint32_t i = 0; i < 1'000'000; ++i) {
        const StateHash hash = entity(1 + i % 3, i / 3, static_cast<float>(i % 7));
        ASSERT_TRUE(seen.emplace(hash.low, hash.high).second) << i;
    }
}

std::array<std::uint32_t*, 7> fields(HashedWords& words) {
    return {&words.kind, &words.id, &words.a, &words.b, &words.c, &words.d, &words.e};
}

HashedWords some_words(RandomStream& random) {
    HashedWords words{};
    for (std::uint32_t* field : fields(words)) {
        *field = random.word();
    }
    return words;
}

TEST(HashOfWords, ChangesNearlyHalfOfItsBitsWithAnyBitOfAnyField) {
    RandomStream random{RandomKey{Seed{1}, Purpose::ScenarioTest, 0, 0}, 0};
    for (std::size_t field = 0; field < 7; ++field) {
        for (unsigned bit = 0; bit < 32; ++bit) {
            double changed_low = 0, changed_high = 0;
            constexpr int trials = 200;
            for (int trial = 0; trial < trials; ++trial) {
                HashedWords words = some_words(random);
                const StateHash before = hash_of(words);
                *fields(words)[field] ^= 1u << bit;
                const StateHash after = hash_of(words);
                ASSERT_NE(after.low, before.low) << field << ", " << bit;
                ASSERT_NE(after.high, before.high) << field << ", " << bit;
                changed_low += std::popcount(after.low ^ before.low);
                changed_high += std::popcount(after.high ^ before.high);
            }
            EXPECT_GT(changed_low / trials, 16) << field << ", " << bit;
            EXPECT_GT(changed_high / trials, 16) << field << ", " << bit;
        }
    }
}

TEST(HashOfWords, DiffersForAMillionSimilarEntities) {
    // Similar to organisms: small ids, and fields that are often 0 or equal to those of others.
    std::set<std::uint64_t> low, high;
    for (std::uint32_t i = 0; i < 1'000'000; ++i) {
        const StateHash hash =
            hash_of({.kind = 1, .id = i / 16, .a = i % 2, .b = i / 2 % 2, .c = 0, .d = i / 4 % 2, .e = i / 8 % 2});
        low.insert(hash.low);
        high.insert(hash.high);
    }
    EXPECT_EQ(low.size(), 1'000'000u);
    EXPECT_EQ(high.size(), 1'000'000u);
}

TEST(HashOfWords, DependsOnWhichEntityHasWhichFields) {
    RandomStream random{RandomKey{Seed{2}, Purpose::ScenarioTest, 0, 0}, 0};
    for (int trial = 0; trial < 10'000; ++trial) {
        HashedWords first = some_words(random), second = some_words(random);
        const StateHash before = hash_of(first) + hash_of(second);
        const std::size_t field = 1 + random.below(6);
        std::swap(*fields(first)[field], *fields(second)[field]);
        const StateHash after = hash_of(first) + hash_of(second);
        ASSERT_NE(after.low, before.low);
        ASSERT_NE(after.high, before.high);
    }
}

TEST(StateHash, IsWrittenAsHexadecimalHighWordFirst) {
    EXPECT_EQ(to_text(StateHash{.low = 0x12, .high = 0xab}), "00000000000000ab0000000000000012");
}

} // namespace
} // namespace evod::base
