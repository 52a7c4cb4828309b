#include "server/simulation/shared/share.h"

#include <gtest/gtest.h>

namespace evod::simulation::shared {
namespace {

TEST(Shares, DivideAllIslandsIntoNearlyEqualRanges) {
    for (std::size_t islands = 1; islands <= 40; ++islands) {
        for (std::uint32_t size = 1; size <= islands; ++size) {
            std::size_t next = 0;
            for (std::uint32_t rank = 0; rank < size; ++rank) {
                const base::Range share = share_of(islands, rank, size);
                ASSERT_EQ(share.begin, next);
                ASSERT_GE(share.end - share.begin, islands / size);
                ASSERT_LE(share.end - share.begin, islands / size + 1);
                for (; next < share.end; ++next) {
                    ASSERT_EQ(rank_of(islands, next, size), rank);
                }
            }
            ASSERT_EQ(next, islands);
        }
    }
}

} // namespace
} // namespace evod::simulation::shared
