#include "client/viewer/panels/breeding/comparison.h"

#include "tests/unit/viewer/panels/breeding/made_up.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

using made_up::record_of;
using testing::ElementsAre;

TEST(Comparison, HoldsTheLawOfTheServerByRank) {
    const BreedingRecord record = record_of(made_up::wheel());
    const auto comparison = compare(record);
    ASSERT_TRUE(comparison);
    EXPECT_THAT(comparison->organisms, ElementsAre(0, 2, 3, 1));
    EXPECT_THAT(comparison->fitness, ElementsAre(40, 30, 20, 10));
    EXPECT_THAT(comparison->copies, ElementsAre(2, 1, 1, 0));
    for (std::size_t rank = 0; rank < 4; ++rank) {
        const evod::v1::Contender& contender = *record.contender(comparison->organisms[rank]);
        EXPECT_EQ(comparison->expected.copies[rank], contender.expected_copies());
        EXPECT_EQ(comparison->expected.standard_error[rank], contender.expected_copies_error());
        EXPECT_EQ(comparison->expected.unpicked_chance[rank], contender.unpicked_chance());
    }
    // Four spins with share 0.4: 1.6 copies with a deviation of sqrt(4 · 0.4 · 0.6).
    EXPECT_NEAR(comparison->deviations[0], 0.4 / std::sqrt(0.96), 1e-12);
    EXPECT_EQ(comparison->beyond_two, 0u);
    EXPECT_FALSE(comparison->predictions.empty());
}

TEST(Comparison, NeedsAllContendersAndValidRanks) {
    evod::v1::Breeding breeding = made_up::wheel();
    breeding.mutable_contenders()->RemoveLast();
    EXPECT_FALSE(compare(record_of(breeding)));
    EXPECT_FALSE(compare(BreedingRecord{BreedingRecord::Key{}}));
    breeding = made_up::wheel();
    breeding.mutable_contenders(0)->set_rank(4);
    EXPECT_FALSE(compare(record_of(breeding)));
}

TEST(CopiesAfter, CountsThePicksSoFarByRank) {
    const BreedingRecord record = record_of(made_up::wheel());
    EXPECT_THAT(copies_after(record, 0), ElementsAre(0, 0, 0, 0));
    EXPECT_THAT(copies_after(record, 2), ElementsAre(1, 1, 0, 0));
    EXPECT_THAT(copies_after(record, 4), ElementsAre(2, 1, 1, 0));
    EXPECT_THAT(copies_after(record, 99), ElementsAre(2, 1, 1, 0));
}

TEST(PickColumns, ShowEveryPickAtAnyWidth) {
    const BreedingRecord record = record_of(made_up::wheel());
    for (const std::size_t most : {1u, 2u, 3u, 4u, 50u}) {
        const auto columns = pick_columns(record, 3, most);
        ASSERT_EQ(columns.size(), std::min<std::size_t>(most, 4));
        std::uint32_t next = 0;
        for (const PickColumn& column : columns) {
            EXPECT_EQ(column.first, next);
            EXPECT_TRUE(column.rank);
            next = column.last + 1;
        }
        EXPECT_EQ(next, 4u);
    }
    EXPECT_TRUE(pick_columns(record, 3, 0).empty());
}

TEST(PickColumns, ShowTheMeanRankOfThePicksMade) {
    const BreedingRecord record = record_of(made_up::wheel());
    const auto rank_of = [&](std::uint32_t pick) -> double {
        return record.contender(record.pick(pick)->organism())->rank();
    };
    const auto done = pick_columns(record, 3, 2);
    EXPECT_EQ(done[0].rank, (rank_of(0) + rank_of(1)) / 2);
    EXPECT_EQ(done[1].rank, (rank_of(2) + rank_of(3)) / 2);
    const auto begun = pick_columns(record, 0, 2);
    EXPECT_EQ(begun[0].rank, rank_of(0));
    EXPECT_EQ(begun[1].rank, std::nullopt);
}

TEST(RankColumns, AddUpToTheWhole) {
    const auto comparison = compare(record_of(made_up::wheel()));
    for (const std::size_t most : {1u, 2u, 3u, 4u, 50u}) {
        const auto columns = rank_columns(*comparison, comparison->copies, 0.5, most);
        ASSERT_EQ(columns.size(), std::min<std::size_t>(most, 4));
        double copies = 0, expected = 0;
        std::size_t next = 0;
        for (const RankColumn& column : columns) {
            EXPECT_EQ(column.first, next);
            next = column.last + 1;
            copies += column.copies;
            expected += column.expected;
        }
        EXPECT_EQ(next, 4u);
        EXPECT_EQ(copies, 4);
        EXPECT_NEAR(expected, 2, 1e-12);
    }
}

TEST(RankColumns, DeviateAsTheSumOfTheirRanks) {
    const auto comparison = compare(record_of(made_up::wheel()));
    const auto single = rank_columns(*comparison, copies_after(record_of(made_up::wheel()), 1), 0.25, 4);
    for (std::size_t rank = 0; rank < 4; ++rank) {
        EXPECT_EQ(single[rank].deviation, comparison->deviations[rank])
            << "after all picks, not after those made so far";
    }
    const auto two = rank_columns(*comparison, comparison->copies, 1, 2);
    EXPECT_NEAR(two[0].deviation, (3 - 2.8) / std::sqrt(4 * 0.4 * 0.6 + 4 * 0.3 * 0.7), 1e-12);
}

} // namespace
} // namespace evod::viewer
