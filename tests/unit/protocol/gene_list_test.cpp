#include "server/protocol/gene_list.h"

#include "server/parameters/gene_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace evod::protocol {
namespace {

TEST(GeneListMessage, IsConvertedBothWays) {
    const auto genes = parameters::parse_gene_list(R"([
        {"name": "rate", "min": 0.5, "max": 2, "scale": "logarithmic", "mutation_step": 0.25},
        {"name": "layers", "min": 1, "max": 8, "step": 1}, {"choices": ["a", "b"]}, {"permutation": 4}])");
    ASSERT_TRUE(genes);
    v1::FreeGeneList message;
    to_proto(*genes, message);
    std::vector<base::Violation> violations;
    EXPECT_EQ(to_gene_list(message, "free_genes", violations), *genes);
    EXPECT_THAT(violations, testing::IsEmpty());
}

TEST(GeneListMessage, FaultsNameTheField) {
    v1::FreeGeneList message;
    v1::FreeGene& gene = *message.add_genes();
    gene.set_name("x");
    std::vector<base::Violation> violations;
    EXPECT_TRUE(to_gene_list(message, "reset_world.free_genes", violations).empty());
    ASSERT_EQ(violations.size(), 1u); // max is 0, as min
    EXPECT_EQ(violations[0].field, "reset_world.free_genes[0].max");
    gene.add_choices("a");
    gene.set_permutation(3);
    EXPECT_TRUE(to_gene_list(message, "free_genes", violations).empty());
    EXPECT_EQ(violations[1].got, "both");
    v1::FreeGeneList long_list;
    for (int i = 0; i < 1001; ++i) {
        long_list.add_genes();
    }
    EXPECT_TRUE(to_gene_list(long_list, "free_genes", violations).empty());
    EXPECT_EQ(violations[2].allowed, "at most 1000 genes");
}

} // namespace
} // namespace evod::protocol
