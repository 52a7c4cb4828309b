#include "client/viewer/world/gene_groups.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

using evod::v1::GENE_GROUP_BODY;
using evod::v1::GENE_GROUP_BRAIN;
using evod::v1::GENE_GROUP_FREE;

TEST(GeneGroups, AreRangesOfTheChromosome) {
    const GeneGroups groups{GENE_GROUP_BODY, GENE_GROUP_BODY, GENE_GROUP_BRAIN, GENE_GROUP_FREE};
    EXPECT_EQ(genes_of(groups, GENE_GROUP_BODY), (GeneRange{0, 2}));
    EXPECT_EQ(genes_of(groups, GENE_GROUP_BRAIN), (GeneRange{2, 1}));
    EXPECT_EQ(genes_of({}, GENE_GROUP_BRAIN).count, 0u);
    EXPECT_FALSE((GeneRange{2, 1}).contains(1));
    EXPECT_TRUE((GeneRange{2, 1}).contains(2));
    EXPECT_FALSE((GeneRange{2, 1}).contains(3));
}

} // namespace
} // namespace evod::viewer
