#include "client/viewer/panels/family_tree/family_tree.h"

#include "tests/unit/viewer/world/lineage_table.h"

#include <gmock/gmock.h>

#include <numeric>
#include <random>

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Parents = FamilyTree::Parents;

/// The tree of all organisms of the last generation.
FamilyTree tree_of(const Lineage& lineage, Parents parents) {
    std::vector<std::uint32_t> roots(lineage.at(lineage.last()).organisms.size());
    std::iota(roots.begin(), roots.end(), 0u);
    return {lineage, lineage.last(), roots, parents};
}

std::vector<std::uint32_t> organisms_of(const FamilyTree& tree, std::uint64_t generation) {
    std::vector<std::uint32_t> organisms;
    for (const FamilyTree::Spot& spot : tree.row(generation)) {
        organisms.push_back(spot.organism);
    }
    return organisms;
}

/// A lineage whose organisms have random parents.
Lineage random_lineage(std::uint32_t size, std::uint64_t generations) {
    std::mt19937 generator{7};
    const auto random = [&] { return static_cast<std::uint32_t>(generator()); };
    std::vector<TableGeneration> table{TableGeneration(size)};
    while (table.size() < generations) {
        TableGeneration children;
        for (std::uint32_t i = 0; i < size; ++i) {
            children.push_back({random() % size, random() % size});
        }
        table.push_back(std::move(children));
    }
    return lineage_of(table);
}

/// Three generations. 3 has no children, and the only child of 2 has no children.
const std::vector<TableGeneration> small{{{}, {}, {}, {}}, {{0, 1}, {1, 0}, {2}}, {{1, 0}, {0, 1}, {1}}};

TEST(FamilyTree, ExtinctLinesAreLeftOut) {
    const FamilyTree tree = tree_of(lineage_of(small), Parents::First);
    EXPECT_EQ(tree.first(), 1u);
    EXPECT_EQ(tree.last(), 3u);
    EXPECT_THAT(organisms_of(tree, 1), ElementsAre(0, 1));
    EXPECT_THAT(organisms_of(tree, 2), ElementsAre(0, 1));
    EXPECT_THAT(organisms_of(tree, 3), ElementsAre(1, 0, 2)) << "1 is a child of the leftmost parent";
    EXPECT_EQ(tree.place_of(3, 0), 1u);
    EXPECT_EQ(tree.place_of(2, 2), FamilyTree::none);
    EXPECT_EQ(tree.place_of(9, 0), FamilyTree::none);
    EXPECT_EQ(tree.placed_count(), 0u);
}

TEST(FamilyTree, PlacedOrganismsBeginALine) {
    FamilyTree tree = tree_of(lineage_of({{{}, {}}, {{0, 1}, {}}, {{0, 1}, {1, 0}}}), Parents::First);
    EXPECT_EQ(tree.placed_count(), 1u);
    EXPECT_THAT(organisms_of(tree, 1), ElementsAre(0));
    EXPECT_THAT(organisms_of(tree, 2), ElementsAre(0, 1));
    EXPECT_EQ(tree.common_generation(), std::nullopt);
    tree.set_base(1);
    EXPECT_EQ(tree.row(3)[0].founder, 0u);
    EXPECT_EQ(tree.row(3)[1].founder, FamilyTree::none);
}

TEST(FamilyTree, ParentsAreAboveTheMiddleOfTheirChildren) {
    const FamilyTree tree = tree_of(lineage_of(small), Parents::First);
    EXPECT_EQ(tree.width(), 3);
    EXPECT_EQ(tree.row(3)[0].x, 0.5);
    EXPECT_EQ(tree.row(2)[0].x, 0.5);
    EXPECT_EQ(tree.row(2)[1].x, 2);
    EXPECT_EQ(tree.row(1)[1].x, 2);
    EXPECT_EQ(tree.row(2)[1].child_count, 2u);
}

TEST(FamilyTree, AChainOfSingleDescentIsOneLine) {
    // From 1: a chain of three, then two children, of which one survives as a copy of itself.
    const FamilyTree tree = tree_of(lineage_of({{{}, {}}, {{1}}, {{0}}, {{0, 0}, {0}}, {{0}, {1}}}), Parents::First);
    ASSERT_EQ(tree.lines().size(), 3u);
    const auto is = [&](std::size_t index, std::uint64_t top, std::uint64_t bottom) {
        EXPECT_EQ(tree.lines()[index].top, top) << index;
        EXPECT_EQ(tree.lines()[index].bottom, bottom) << index;
    };
    is(0, 1, 3);
    is(1, 3, 5);
    is(2, 3, 5);
    EXPECT_EQ(tree.common_generation(), 3u);
    EXPECT_THAT(tree.common_ancestors(), ElementsAre(0));
}

TEST(FamilyTree, BothParentsAreInAPedigree) {
    const FamilyTree tree = tree_of(lineage_of(small), Parents::Both);
    EXPECT_THAT(organisms_of(tree, 1), ElementsAre(0, 1));
    const FamilyTree::Spot& child = tree.row(3)[0];
    EXPECT_EQ(child.organism, 1u);
    EXPECT_EQ(child.first, 0u);
    EXPECT_EQ(child.second, 1u);
    const FamilyTree::Spot& survivor = tree.row(3)[2];
    EXPECT_EQ(survivor.organism, 2u);
    EXPECT_EQ(survivor.first, 1u);
    EXPECT_EQ(survivor.second, FamilyTree::none) << "it has one parent";
    EXPECT_THAT(tree.lines(), IsEmpty());
}

TEST(FamilyTree, APedigreeHasALaterCommonAncestorThanTheLines) {
    // First parents form two lines that never meet. Organism 0 of generation 2 is the second parent of the other line.
    const Lineage lineage = lineage_of({{{}, {}}, {{0}, {1}}, {{0}, {1, 0}}});
    const FamilyTree lines = tree_of(lineage, Parents::First);
    EXPECT_EQ(lines.common_generation(), std::nullopt);
    const FamilyTree pedigree = tree_of(lineage, Parents::Both);
    EXPECT_EQ(pedigree.common_generation(), 2u);
    ASSERT_THAT(pedigree.common_ancestors(), ElementsAre(0));
    EXPECT_EQ(pedigree.row(2)[0].organism, 0u);
    EXPECT_EQ(pedigree.all_common_generation(), std::nullopt) << "1 is an ancestor of one organism only";
}

TEST(FamilyTree, BeforeAGenerationEveryOrganismIsAnAncestorOfAll) {
    const Lineage lineage = lineage_of({{{}, {}}, {{0, 1}, {1, 0}}, {{0}, {1, 0}}});
    const FamilyTree pedigree = tree_of(lineage, Parents::Both);
    EXPECT_EQ(pedigree.common_generation(), 2u);
    EXPECT_EQ(pedigree.all_common_generation(), 1u);
    EXPECT_EQ(pedigree.row(1).size(), 2u);
}

TEST(FamilyTree, OneOrganismHasNoCommonAncestor) {
    const Lineage lineage = lineage_of(small);
    const std::uint32_t root[] = {1};
    const FamilyTree tree{lineage, 3, root, Parents::Both};
    EXPECT_THAT(organisms_of(tree, 2), ElementsAre(0, 1));
    EXPECT_EQ(tree.common_generation(), std::nullopt);
    EXPECT_TRUE((FamilyTree{lineage, 3, {}, Parents::Both}.empty()));
}

TEST(FamilyTree, FoundersAreAncestorsInTheBaseGeneration) {
    FamilyTree tree = tree_of(lineage_of(small), Parents::First);
    tree.set_base(2);
    EXPECT_EQ(tree.row(1)[0].founder, FamilyTree::none) << "before the base";
    EXPECT_EQ(tree.row(2)[1].founder, 1u);
    EXPECT_EQ(tree.row(3)[0].founder, 0u);
    EXPECT_EQ(tree.row(3)[2].founder, 1u);
}

TEST(FamilyTree, LinesOfFirstParentsNeverCross) {
    const Lineage lineage = random_lineage(40, 30);
    for (const Parents parents : {Parents::First, Parents::Both}) {
        const FamilyTree tree = tree_of(lineage, parents);
        for (std::uint64_t generation = tree.first() + 1; generation <= tree.last(); ++generation) {
            const FamilyTree::Row& row = tree.row(generation);
            for (std::size_t i = 1; i < row.size(); ++i) {
                EXPECT_LE(row[i - 1].first, row[i].first) << generation;
                EXPECT_LT(row[i - 1].x, row[i].x) << generation;
            }
        }
    }
}

TEST(FamilyTree, EveryParentIsTheOneInTheLineage) {
    const Lineage lineage = random_lineage(40, 30);
    const FamilyTree tree = tree_of(lineage, Parents::Both);
    for (std::uint64_t generation = tree.first() + 1; generation <= tree.last(); ++generation) {
        for (const FamilyTree::Spot& spot : tree.row(generation)) {
            const auto [first, second] = lineage.at(generation).organisms[spot.organism].parents;
            EXPECT_EQ(tree.row(generation - 1)[spot.first].organism, first);
            if (first != second) {
                EXPECT_EQ(tree.row(generation - 1)[spot.second].organism, second);
            }
        }
    }
}

TEST(FamilyTree, LargePedigreesAreBuilt) {
    const FamilyTree deep = tree_of(random_lineage(50, 1'000), Parents::Both);
    EXPECT_EQ(deep.first(), 1u);
    EXPECT_EQ(deep.last(), 1'000u);
    EXPECT_GT(deep.all_common_generation(), 900u);
    const Lineage wide_lineage = random_lineage(10'000, 50);
    const FamilyTree wide = tree_of(wide_lineage, Parents::Both);
    EXPECT_EQ(wide.row(50).size(), 10'000u);
    EXPECT_GT(wide.common_generation(), 30u) << "log2(10,000) is about 13 generations";
    EXPECT_EQ(tree_of(wide_lineage, Parents::First).common_generation(), std::nullopt);
}

TEST(FamilyTree, TheFirstViewBeginsShortlyBeforeTheLinesMeet) {
    std::vector<TableGeneration> generations{{{}, {}}};
    while (generations.size() < 100) {
        generations.push_back({{0}, {generations.size() < 80 ? 0u : 1u}});
    }
    const FamilyTree tree = tree_of(lineage_of(generations), Parents::First);
    ASSERT_EQ(tree.common_generation(), 79u);
    const Range fitted = fitted_generations(tree);
    EXPECT_EQ(fitted.max, 100.5);
    EXPECT_LT(fitted.min, 79);
    EXPECT_GT(fitted.min, 70);
    EXPECT_EQ(whole_generations(tree), (Range{0.5, 100.5}));
    EXPECT_EQ(fitted_generations(tree_of(lineage_of(small), Parents::First)).max, 3.5);
}

} // namespace
} // namespace evod::viewer
