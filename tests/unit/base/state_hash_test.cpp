#include "server/base/state_hash.h"

#include <gtest/gtest.h>

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

TEST(StateHash, TellsApartWhoHasWhichFields) {
    EXPECT_NE(entity(1, 1, 10) + entity(1, 2, 20), entity(1, 1, 20) + entity(1, 2, 10));
    EXPECT_NE(entity(1, 1, 10), entity(2, 1, 10));
    EXPECT_NE(entity(1, 1, 0.0f), entity(1, 1, -0.0f));
}

TEST(StateHash, AnEntityCanBeTakenOutAgain) {
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

TEST(StateHash, IsWrittenAsHexadecimalHighWordFirst) {
    EXPECT_EQ(to_text(StateHash{.low = 0x12, .high = 0xab}), "00000000000000ab0000000000000012");
}

} // namespace
} // namespace evod::base
