#include "client/viewer/panels/breeding/tournament.h"

#include "tests/unit/viewer/panels/breeding/made_up.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

using made_up::record_of;

/// A pick of `organism` in the tournament, among the contestants.
void add_pick(evod::v1::Breeding& breeding, std::uint32_t organism, std::uint32_t tournament,
              std::initializer_list<std::uint32_t> contestants) {
    auto& pick = *breeding.add_picks();
    pick.set_organism(organism);
    pick.set_tournament(tournament);
    for (const std::uint32_t contestant : contestants) {
        pick.add_contestants(contestant);
    }
}

TEST(Tournament, MarksOnlyItsWinner) {
    evod::v1::Breeding breeding = made_up::wheel();
    breeding.clear_picks();
    add_pick(breeding, 2, 0, {1, 2, 3});
    add_pick(breeding, 2, 1, {2, 3, 3});
    const auto contestants = contestants_of(record_of(breeding), 0);
    ASSERT_EQ(contestants.size(), 3u);
    for (const Contestant& contestant : contestants) {
        EXPECT_EQ(contestant.won, contestant.organism == 2);
        EXPECT_EQ(contestant.picked_now, contestant.organism == 2);
    }
}

TEST(Tournament, MarksAllWinnersAndTheCurrentPick) {
    evod::v1::Breeding breeding = made_up::wheel();
    breeding.clear_picks();
    add_pick(breeding, 3, 0, {3, 3, 3, 3}); // a pick of the tournament before
    add_pick(breeding, 0, 1, {0, 1, 0, 2});
    add_pick(breeding, 0, 1, {0, 1, 0, 2});
    add_pick(breeding, 2, 1, {0, 1, 0, 2});
    const auto contestants = contestants_of(record_of(breeding), 2);
    ASSERT_EQ(contestants.size(), 4u);
    EXPECT_TRUE(contestants[0].won);
    EXPECT_FALSE(contestants[0].picked_now);
    EXPECT_FALSE(contestants[1].won);
    EXPECT_TRUE(contestants[2].won) << "drawn twice, it won twice";
    EXPECT_TRUE(contestants[2].picked_now);
    EXPECT_TRUE(contestants[3].won);
    EXPECT_FALSE(contestants[3].picked_now);
}

TEST(Tournament, AWheelPickHasNoContestants) {
    EXPECT_TRUE(contestants_of(record_of(made_up::wheel()), 0).empty());
    EXPECT_TRUE(contestants_of(record_of(made_up::wheel()), 99).empty());
}

} // namespace
} // namespace evod::viewer
