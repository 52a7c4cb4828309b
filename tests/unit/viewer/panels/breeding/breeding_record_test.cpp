#include "client/viewer/panels/breeding/breeding_record.h"

#include "tests/unit/viewer/panels/breeding/made_up.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

BreedingRecord record_of_seven() {
    return BreedingRecord{{.world = "default", .run_id = "a", .island = 1, .generation = 7}};
}

/// Rows [first, first + count) of each list.
evod::v1::Breeding page(const evod::v1::Breeding& whole, const evod::v1::GetBreeding& asked, int rows) {
    evod::v1::Breeding part = whole;
    const auto cut = [rows](auto& list, const auto& all, std::uint32_t first) {
        list.Clear();
        for (int i = static_cast<int>(first); i < std::min(static_cast<int>(first) + rows, all.size()); ++i) {
            *list.Add() = all.Get(i);
        }
    };
    cut(*part.mutable_contenders(), whole.contenders(), asked.first_contender());
    cut(*part.mutable_picks(), whole.picks(), asked.first_pick());
    cut(*part.mutable_descendants(), whole.descendants(), asked.first_descendant());
    return part;
}

TEST(BreedingRecord, CollectsAllPagesInOrder) {
    const evod::v1::Breeding whole = made_up::wheel();
    BreedingRecord record = record_of_seven();
    unsigned asked = 0;
    for (const Moment moment : {Moment{}, Moment{BreedingStage::Picking, 0}, Moment{BreedingStage::Breeding, 0}}) {
        while (const auto wanted = record.wanted(moment)) {
            EXPECT_EQ(wanted->world(), "default");
            EXPECT_EQ(wanted->island(), 1u);
            EXPECT_EQ(wanted->generation(), 7u);
            record.add(page(whole, *wanted, 3));
            ASSERT_LE(++asked, 4u);
        }
    }
    // The first page, the last contender, the last pick, the last descendant.
    EXPECT_EQ(asked, 4u);
    EXPECT_EQ(record.breeding().SerializeAsString(), whole.SerializeAsString());
}

TEST(BreedingRecord, RequestsAListItDoesNotNeedFromItsEnd) {
    const evod::v1::Breeding whole = made_up::wheel();
    BreedingRecord record = record_of_seven();
    record.add(page(whole, *record.wanted({}), 3));
    const auto wanted = record.wanted({});
    ASSERT_TRUE(wanted);
    EXPECT_EQ(wanted->first_contender(), 3u);
    EXPECT_EQ(wanted->first_pick(), 4u);
    EXPECT_EQ(wanted->first_descendant(), 4u);
}

TEST(BreedingRecord, StopsAskingAServerThatSendsNothing) {
    const evod::v1::Breeding whole = made_up::wheel();
    BreedingRecord record = record_of_seven();
    record.add(page(whole, *record.wanted({}), 3));
    record.add(page(whole, *record.wanted({}), 0));
    EXPECT_FALSE(record.wanted({}));
}

TEST(BreedingRecord, IgnoresAnotherGenerationOrIsland) {
    for (const bool island : {true, false}) {
        evod::v1::Breeding other = made_up::wheel();
        island ? other.set_island(0) : other.set_generation(8);
        BreedingRecord record = record_of_seven();
        record.add(other);
        EXPECT_FALSE(record.known());
    }
}

TEST(BreedingRecord, KeepsAtMostRowsKeptMax) {
    evod::v1::Breeding huge = made_up::wheel();
    huge.set_contender_count(4'000'000);
    huge.set_pick_count(4'000'000);
    BreedingRecord record = record_of_seven();
    record.add(huge);
    EXPECT_EQ(record.pick_count(), BreedingRecord::rows_kept_max);
    evod::v1::Breeding more;
    more.set_generation(7);
    more.set_island(1);
    for (std::uint32_t i = 0; i < BreedingRecord::rows_kept_max; ++i) {
        more.add_contenders();
    }
    record.add(more);
    EXPECT_EQ(record.breeding().contenders_size(), static_cast<int>(BreedingRecord::rows_kept_max));
    EXPECT_FALSE(record.wanted({}));
    EXPECT_EQ(record.contender(BreedingRecord::rows_kept_max), nullptr);
}

TEST(BreedingRecord, ReturnsParametersByName) {
    evod::v1::Breeding breeding = made_up::wheel();
    made_up::set_count(breeding, "tournament_size", 5);
    BreedingRecord record = record_of_seven();
    EXPECT_EQ(record.choice("selection"), "");
    record.add(breeding);
    EXPECT_EQ(record.choice("selection"), "roulette");
    EXPECT_EQ(record.number("tournament_size"), 5);
    EXPECT_EQ(record.number("selection"), std::nullopt);
    EXPECT_EQ(record.number("nothing"), std::nullopt);
}

} // namespace
} // namespace evod::viewer
