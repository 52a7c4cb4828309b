#include "client/viewer/panels/breeding/family.h"

#include "tests/unit/viewer/panels/breeding/made_up.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(Family, GenesComeFromTheParentInTheMask) {
    const Family family = family_of(made_up::child(0b001110));
    EXPECT_THAT(family.genes, ElementsAre(1, 12, 13, 14, 5, 6));
    EXPECT_THAT(family.cuts, ElementsAre(1, 4));
    EXPECT_FALSE(family.crossed[0].from_second);
    EXPECT_TRUE(family.crossed[3].from_second);
}

TEST(Family, BlendedGenesAreWeightedMeans) {
    evod::v1::Descendant child = made_up::child(0);
    child.set_second_share(0.25);
    const Family family = family_of(child);
    EXPECT_THAT(family.genes, ElementsAre(3.5f, 4.5f, 5.5f, 6.5f, 7.5f, 8.5f));
    EXPECT_THAT(family.cuts, IsEmpty());
    EXPECT_TRUE(family.crossed[0].blended);
    EXPECT_FALSE(family_of(made_up::child(1)).crossed[0].blended);
}

TEST(Family, LongMasksHaveFurtherWords) {
    evod::v1::Descendant child;
    for (int gene = 0; gene < 70; ++gene) {
        child.add_first_genes(1);
        child.add_second_genes(2);
    }
    child.set_from_second(0x8000'0000);
    child.add_more_from_second(1);
    const Family family = family_of(child); // the word of the last six genes is absent: they are from the first parent
    ASSERT_EQ(family.genes.size(), 70u);
    EXPECT_THAT(family.cuts, ElementsAre(31, 33));
    EXPECT_EQ(family.genes[31], 2);
    EXPECT_EQ(family.genes[32], 2);
    EXPECT_EQ(family.genes[69], 1);
}

TEST(Family, WeightsAreGroupedByTheirNeuron) {
    const std::vector<std::string> names{"impulse", "hidden1<food_bearing", "hidden1<bias", "turn<hidden1", "free1",
                                         "free2"};
    EXPECT_THAT(gene_blocks(names, 1), ElementsAre(GeneBlock{"hidden1", "hidden1", 1, 2},
                                                   GeneBlock{"turn", "turn", 3, 1}, GeneBlock{"free1", "", 4, 2}));
    EXPECT_EQ(gene_blocks(std::vector<std::string>(33, "free"), 0).size(), 3u) << "blocks of 16";
    EXPECT_THAT(gene_blocks(names, names.size()), IsEmpty());
}

TEST(Family, AGeneIsDescribedByItsOriginAndChanges) {
    evod::v1::Descendant child = made_up::child(0b000010);
    child.set_first_parent(12);
    child.set_second_parent(45);
    made_up::mutate(child, evod::v1::MUTATION_KIND_CREEP, 1, 12, 12.5f);
    const Family family = family_of(child);
    EXPECT_EQ(gene_text(family, 0, "a<b", child), "a<b: 1 of parent 12");
    EXPECT_EQ(gene_text(family, 1, "a<c", child), "a<c: 12 of parent 45, creep to 12.5");
    child.set_from_second(0);
    child.set_second_share(0.5);
    EXPECT_EQ(gene_text(family_of(child), 0, "a<b", child), "a<b: 6, a mean of both parents");
}

TEST(Family, ACopyOfOneParentHasNoCuts) {
    EXPECT_THAT(family_of(made_up::child(0)).cuts, IsEmpty());
    const Family second = family_of(made_up::child(0xffff'ffff)); // a complement may have bits beyond the genes
    EXPECT_THAT(second.cuts, IsEmpty());
    EXPECT_THAT(second.genes, ElementsAre(11, 12, 13, 14, 15, 16));
}

TEST(Family, ReorderedGenesKeepTheirParent) {
    evod::v1::Descendant child = made_up::child(0b000001);
    child.mutable_order_mutation()->set_method("inversion");
    for (const std::uint32_t from : {2u, 1u, 0u, 3u, 4u, 5u}) {
        child.mutable_order_mutation()->add_order(from);
    }
    const Family family = family_of(child);
    EXPECT_THAT(family.genes, ElementsAre(3, 2, 11, 4, 5, 6));
    EXPECT_THAT(family.moves, ElementsAre(GeneMove{2, 0}, GeneMove{0, 2}));
    EXPECT_TRUE(family.arranged[2].from_second);
    EXPECT_EQ(family.arranged[2].gene, 0u);
}

TEST(Family, MutationsApplyInOrderAndAClampComesLast) {
    evod::v1::Descendant child = made_up::child(0);
    made_up::mutate(child, evod::v1::MUTATION_KIND_CREEP, 5, 6, 9);
    made_up::mutate(child, evod::v1::MUTATION_KIND_CREEP, 2, 3, 2.5f);
    made_up::mutate(child, evod::v1::MUTATION_KIND_CLAMP, 5, 9, 8);
    const Family family = family_of(child);
    EXPECT_THAT(family.genes, ElementsAre(1, 2, 2.5f, 4, 5, 8));
    ASSERT_EQ(family.changes.size(), 3u);
    EXPECT_EQ(family.changes[0].delta(), 3);
    EXPECT_EQ(family.changes[1].delta(), -0.5);
    EXPECT_EQ(family.changes[2].kind, evod::v1::MUTATION_KIND_CLAMP);
}

TEST(Family, ASurvivorHasOnlyItself) {
    evod::v1::Descendant survivor = made_up::child(0);
    survivor.set_kind(evod::v1::DESCENDANT_KIND_SURVIVOR);
    survivor.clear_second_genes();
    EXPECT_THAT(family_of(survivor).genes, ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(Family, MalformedListsGiveNoGenes) {
    evod::v1::Descendant torn = made_up::child(0);
    torn.mutable_second_genes()->RemoveLast();
    EXPECT_THAT(family_of(torn).genes, IsEmpty());
    evod::v1::Descendant far = made_up::child(0);
    made_up::mutate(far, evod::v1::MUTATION_KIND_RESET, 6, 1, 2);
    EXPECT_THAT(family_of(far).genes, IsEmpty());
    evod::v1::Descendant order = made_up::child(0);
    for (const std::uint32_t from : {0u, 1u, 2u, 3u, 4u, 6u}) {
        order.mutable_order_mutation()->add_order(from);
    }
    EXPECT_THAT(family_of(order).genes, IsEmpty());
    EXPECT_THAT(family_of(evod::v1::Descendant{}).genes, IsEmpty());
}

TEST(ShownDelta, AlwaysHasASign) {
    EXPECT_EQ(shown_delta(7.3125), "+7.312");
    EXPECT_EQ(shown_delta(-0.5), "−0.5");
    EXPECT_EQ(shown_delta(0), "+0");
}

} // namespace
} // namespace evod::viewer
