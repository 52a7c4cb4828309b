#include "client/viewer/world/lineage.h"

#include "tests/unit/viewer/world/lineage_table.h"

#include <gmock/gmock.h>

#include <cmath>

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Lineage, ReadsTheParentsOfEveryOrganism) {
    const Lineage lineage = lineage_of({{{}, {}, {}}, {{2, 0}, {1}}});
    EXPECT_EQ(lineage.first(), 1u);
    EXPECT_EQ(lineage.last(), 2u);
    const auto& organisms = lineage.at(2).organisms;
    ASSERT_EQ(organisms.size(), 2u);
    EXPECT_THAT(organisms[0].parents, ElementsAre(2, 0));
    EXPECT_THAT(organisms[1].parents, ElementsAre(1, 1)) << "a survivor has one parent";
    EXPECT_EQ(organisms[0].origin, Lineage::Origin::Child);
    EXPECT_EQ(organisms[1].origin, Lineage::Origin::Survivor);
    EXPECT_EQ(organisms[1].fitness, 10);
    EXPECT_THAT(lineage.at(1).organisms[0].parents, ElementsAre(Lineage::none, Lineage::none));
}

TEST(Lineage, FollowsMigrantsToTheirIsland) {
    Lineage lineage;
    lineage.begin_table();
    EXPECT_EQ(lineage.add(std::string{lineage_heading} + "1,0,0,,,,,,,initial,1,,\n1,1,0,,,,,,,initial,1,,\n"
                                                         "1,1,1,,,,,,,initial,1,,\n"
                                                         "2,0,0,1,1,1,1,0,0,child,,,\n2,1,0,1,1,0,1,1,0,elite,,,\n"),
              std::nullopt);
    lineage.end_table();
    EXPECT_THAT(lineage.at(2).organisms[0].parents, ElementsAre(2, 0)) << "from island 1 and from island 0";
    EXPECT_EQ(lineage.place_of(1, 2), (Lineage::Place{1, 1}));
    EXPECT_EQ(lineage.index_of(1, {1, 1}), 2u);
    EXPECT_EQ(lineage.index_of(1, {1, 2}), Lineage::none);
    EXPECT_EQ(lineage.index_of(1, {2, 0}), Lineage::none);
    EXPECT_THAT(lineage.island_range(2, 1), ElementsAre(1, 1));
    EXPECT_TRUE(std::isnan(lineage.at(2).organisms[0].fitness));
}

TEST(Lineage, ATableMayArriveInPartsThatEndWithinRows) {
    const std::string text = lineage_heading + lineage_rows(1, {{}, {}}) + lineage_rows(2, {{0, 1}, {1, 0}});
    Lineage lineage;
    lineage.begin_table();
    for (std::size_t at = 0; at < text.size(); at += 7) {
        ASSERT_EQ(lineage.add(text.substr(at, 7)), std::nullopt);
    }
    lineage.end_table();
    EXPECT_EQ(lineage.last(), 2u);
    EXPECT_THAT(lineage.at(2).organisms[1].parents, ElementsAre(1, 0));
}

TEST(Lineage, ALaterTableContinuesAndReplaces) {
    Lineage lineage = lineage_of({{{}, {}}, {{0, 1}, {1, 0}}});
    const std::uint64_t version = lineage.version();
    lineage.begin_table();
    ASSERT_EQ(lineage.add(lineage_heading + lineage_rows(2, {{1, 0}, {1, 0}}) + lineage_rows(3, {{0}, {0, 1}})),
              std::nullopt);
    EXPECT_EQ(lineage.last(), 2u) << "generation 3 may be incomplete";
    lineage.end_table();
    EXPECT_EQ(lineage.first(), 1u);
    EXPECT_EQ(lineage.last(), 3u);
    EXPECT_THAT(lineage.at(2).organisms[0].parents, ElementsAre(1, 0)) << "replaced";
    EXPECT_GT(lineage.version(), version);
}

TEST(Lineage, BeginsAgainAfterAMissingGeneration) {
    Lineage lineage = lineage_of({{{}, {}}});
    lineage.begin_table();
    ASSERT_EQ(lineage.add(lineage_heading + lineage_rows(3, {{1, 0}})), std::nullopt);
    lineage.end_table();
    EXPECT_EQ(lineage.first(), 3u);
    EXPECT_THAT(lineage.at(3).organisms[0].parents, ElementsAre(Lineage::none, Lineage::none));
}

TEST(Lineage, KeepsTheNewestGenerations) {
    constexpr std::uint32_t size = 100'000;
    Lineage lineage;
    lineage.begin_table();
    lineage.add(lineage_heading);
    for (std::uint64_t generation = 1; generation <= 7; ++generation) {
        lineage.add(lineage_rows(generation, TableGeneration(size, generation == 1 ? std::vector<std::uint32_t>{}
                                                                                   : std::vector<std::uint32_t>{3})));
    }
    lineage.end_table();
    EXPECT_EQ(lineage.first(), 3u);
    EXPECT_EQ(lineage.last(), 7u);
    EXPECT_THAT(lineage.at(3).organisms[0].parents, ElementsAre(Lineage::none, Lineage::none));
    EXPECT_THAT(lineage.at(4).organisms[0].parents, ElementsAre(3, 3));
}

TEST(Lineage, NamesTheLineOfAnInvalidTable) {
    const auto fault_of = [](const std::string& text) {
        Lineage lineage;
        lineage.begin_table();
        return lineage.add(text).value_or("none");
    };
    EXPECT_THAT(fault_of("generation,island\n"), HasSubstr("line 1 of the lineage table: there is no column organism"));
    EXPECT_THAT(fault_of(std::string{lineage_heading} + "1,0,0,,,,,,,initial,1,,\n1,0,x,,,,,,,initial,1,,\n"),
                HasSubstr("line 3 of the lineage table: no organism"));
    EXPECT_THAT(fault_of(std::string{lineage_heading} + "1,0,1,,,,,,,initial,1,,\n"), HasSubstr("not in its place"));
    EXPECT_THAT(fault_of(std::string{lineage_heading} + "2,0,0,1,0,x,1,0,0,child,1,,\n"), HasSubstr("no parent"));
    EXPECT_THAT(fault_of(std::string{lineage_heading} + "1,9999999,0,,,,,,,initial,1,,\n"), HasSubstr("no organism"));
}

TEST(Lineage, AncestorsFollowFirstParents) {
    const Lineage lineage = lineage_of({{{}, {}, {}}, {{2, 0}, {1, 0}}, {{1, 0}, {0, 1}, {0}}});
    EXPECT_THAT(ancestors_of(lineage, 3, 0, 1), ElementsAre(1, 2, 2));
    EXPECT_THAT(ancestors_of(lineage, 3, 0, 3), ElementsAre(0, 1, 2));
    EXPECT_THAT(ancestors_of(lineage, 4, 0, 1), IsEmpty());
    EXPECT_THAT(ancestors_of(lineage, 2, 0, 3), IsEmpty());
    EXPECT_THAT(ancestors_of(lineage, 3, 1, 1), IsEmpty()) << "there is no such island";
}

} // namespace
} // namespace evod::viewer
