#include "client/viewer/panels/breeding/wheel_layout.h"

#include "tests/unit/viewer/panels/breeding/made_up.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

/// `count` slots of equal width.
evod::v1::Breeding even(int count) {
    evod::v1::Breeding breeding;
    for (int i = 0; i < count; ++i) {
        auto& contender = *breeding.add_contenders();
        contender.set_rank(static_cast<std::uint32_t>(i));
        contender.set_slot_begin(double(i) / count);
        contender.set_slot_end(double(i + 1) / count);
    }
    return breeding;
}

TEST(WheelArcs, EachWideSlotHasAnArc) {
    const evod::v1::Breeding breeding = made_up::wheel();
    const auto arcs = wheel_arcs(breeding.contenders(), 1000);
    ASSERT_EQ(arcs.size(), 4u);
    for (std::uint32_t i = 0; i < 4; ++i) {
        EXPECT_EQ(arcs[i].first, i);
        EXPECT_EQ(arcs[i].last, i);
        EXPECT_EQ(arcs[i].begin, breeding.contenders(static_cast<int>(i)).slot_begin());
        EXPECT_EQ(arcs[i].end, breeding.contenders(static_cast<int>(i)).slot_end());
        EXPECT_EQ(arcs[i].rank, breeding.contenders(static_cast<int>(i)).rank());
    }
}

TEST(WheelArcs, NarrowNeighboursMergeAndNoSlotIsLost) {
    constexpr double circumference = 100;
    const auto arcs = wheel_arcs(even(10'000).contenders(), circumference);
    EXPECT_LE(arcs.size(), 100u);
    EXPECT_GE(arcs.size(), 98u); // rounding may make an arc one slot wider
    std::uint32_t next = 0;
    double end = 0;
    for (const Arc& arc : arcs) {
        EXPECT_EQ(arc.first, next);
        EXPECT_EQ(arc.begin, end);
        EXPECT_NEAR(arc.rank, (arc.first + arc.last) / 2.0, 1e-6);
        next = arc.last + 1;
        end = arc.end;
        if (next < 10'000) {
            EXPECT_GE(arc.end - arc.begin, 1 / circumference);
        }
    }
    EXPECT_EQ(next, 10'000u);
    EXPECT_EQ(end, 1);
}

TEST(WheelArcs, AWideSlotBesideNarrowOnesKeepsItsArc) {
    evod::v1::Breeding breeding;
    double end = 0;
    for (const double width : {0.001, 0.5, 0.001, 0.0, 0.001, 0.497}) {
        auto& contender = *breeding.add_contenders();
        contender.set_slot_begin(end);
        contender.set_slot_end(end += width);
    }
    const auto arcs = wheel_arcs(breeding.contenders(), 100);
    ASSERT_EQ(arcs.size(), 4u);
    EXPECT_EQ(arcs[1].first, 1u);
    EXPECT_EQ(arcs[1].last, 1u);
    EXPECT_EQ(arcs[2].first, 2u);
    EXPECT_EQ(arcs[2].last, 4u);
}

TEST(SlotAt, FindsTheSlotOfEveryPick) {
    const evod::v1::Breeding breeding = made_up::wheel();
    for (const auto& pick : breeding.picks()) {
        EXPECT_EQ(slot_at(breeding.contenders(), pick.turns()),
                  &breeding.contenders(static_cast<int>(pick.organism())));
    }
    EXPECT_EQ(slot_at(breeding.contenders(), 0.4), &breeding.contenders(1)) << "an end belongs to the next slot";
    EXPECT_EQ(slot_at(breeding.contenders(), 1), nullptr);
}

TEST(RankColour, GetsDarkerWithEveryRank) {
    const auto light = [](Colour colour) { return 0.299 * colour.red + 0.587 * colour.green + 0.114 * colour.blue; };
    constexpr std::uint32_t count = 60;
    for (std::uint32_t rank = 1; rank < count; ++rank) {
        EXPECT_LT(light(rank_colour(rank, count)), light(rank_colour(rank - 1, count))) << rank;
    }
    EXPECT_EQ(rank_colour(0, 1), rank_colour(0, count));
}

} // namespace
} // namespace evod::viewer
