#include "client/viewer/world/lineage_base.h"

#include "tests/unit/viewer/world/lineage_table.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint32_t size = 10;

/// A generation that copies the one before it.
TableGeneration copies() {
    TableGeneration organisms;
    for (std::uint32_t i = 0; i < size; ++i) {
        organisms.push_back({i});
    }
    return organisms;
}

/// A generation in which 0 has `count` children, and the others copy themselves.
TableGeneration takeover(std::uint32_t count) {
    TableGeneration organisms = copies();
    std::fill_n(organisms.begin(), count, std::vector<std::uint32_t>{0});
    return organisms;
}

/// `count` generations of copies, after the first one.
std::vector<TableGeneration> copied(std::size_t count) {
    std::vector<TableGeneration> generations{TableGeneration(size)};
    generations.resize(count + 1, copies());
    return generations;
}

TEST(LineageBase, IsTheFirstGenerationUntilATakeover) {
    auto generations = copied(3);
    generations.push_back(takeover(8));
    EXPECT_THAT(lineage_bases(lineage_of(generations), 0), Each(1u)) << "8 of 10 have not taken over";
    generations.push_back(takeover(9));
    EXPECT_THAT(lineage_bases(lineage_of(generations), 0), ElementsAre(1, 1, 1, 1, 1, 6))
        << "9 of 10 have the same parent, so that each organism is a lineage";
    EXPECT_THAT(lineage_bases(Lineage{}, 0), IsEmpty());
}

TEST(LineageBase, IsAtMostTenGenerationsBeforeTheTakeover) {
    // 0 has nine children in generation 4; then two of them share the island, generation by generation.
    auto generations = copied(2);
    generations.push_back(takeover(9));
    for (int i = 0; i < 30; ++i) {
        generations.push_back(copies());
    }
    const auto bases = lineage_bases(lineage_of(generations), 0);
    EXPECT_EQ(bases[2], 1u);
    EXPECT_EQ(bases[3], 4u) << "the generation of the takeover: no later one has a lineage that has taken over";
    EXPECT_EQ(bases.back(), 4u) << "it stays";
    // A slow takeover: one more descendant of 0 in each generation.
    auto slow = copied(0);
    for (std::uint32_t i = 2; i <= 9; ++i) {
        for (int k = 0; k < 3; ++k) {
            slow.push_back(copies());
        }
        slow.push_back(takeover(i));
    }
    const auto slow_bases = lineage_bases(lineage_of(slow), 0);
    EXPECT_EQ(slow_bases[slow_bases.size() - 2], 1u);
    EXPECT_EQ(slow_bases.back(), slow.size()) << "the last step gives all nine places to the children of one organism";
}

TEST(LineageBase, IsTheEarliestGenerationWithoutATakeover) {
    // The descendants of 0 take over in generation 2, and those of 1 and 2, its children, share the island.
    auto generations = copied(0);
    generations.push_back(takeover(6));
    for (int i = 0; i < 3; ++i) {
        generations.push_back(copies());
    }
    TableGeneration last = copies();
    last[6] = last[7] = last[8] = {2};
    generations.push_back(last);
    EXPECT_THAT(lineage_bases(lineage_of(generations), 0), ElementsAre(1, 1, 1, 1, 1, 2));
}

TEST(LineageBase, CountsTheOrganismsOfTheIsland) {
    // Two islands of one organism: each is taken over by its only organism.
    Lineage lineage;
    lineage.begin_table();
    ASSERT_EQ(lineage.add(std::string{lineage_heading} + "1,0,0,,,,,,,initial,1,,\n1,1,0,,,,,,,initial,1,,\n"
                                                         "2,0,0,1,1,0,1,1,0,child,1,,\n2,1,0,1,1,0,1,1,0,child,1,,\n"),
              std::nullopt);
    lineage.end_table();
    EXPECT_THAT(lineage_bases(lineage, 0), ElementsAre(1, 2));
    EXPECT_THAT(lineage_bases(lineage, 2), ElementsAre(1, 1)) << "there is no such island";
}

} // namespace
} // namespace evod::viewer
