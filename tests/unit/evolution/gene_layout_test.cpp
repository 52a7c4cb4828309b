#include "server/evolution/gene_layout.h"

#include <gtest/gtest.h>

namespace evod::evolution {
namespace {

TEST(GeneLayout, BeginsWithTheBodyAndEndsWithFreeGenes) {
    Parameters parameters;
    EXPECT_EQ(gene_count(parameters), 6u);
    EXPECT_EQ(gene_layout(parameters).names.back(), "poison_radius");
    parameters.free_genes = 3;
    parameters.free_gene_min = -5;
    parameters.free_gene_max = 7;
    const GeneLayout layout = gene_layout(parameters);
    ASSERT_EQ(layout.names.size(), 9u);
    EXPECT_EQ(layout.names[0], "normal_speed");
    EXPECT_EQ(layout.names[6], "free0");
    EXPECT_EQ(layout.names[8], "free2");
    EXPECT_EQ(layout.groups[5], GeneGroup::Body);
    EXPECT_EQ(layout.groups[6], GeneGroup::Free);
    EXPECT_EQ(layout.bounds.min[8], -5);
    EXPECT_EQ(layout.bounds.max[6], 7);
    EXPECT_EQ(layout.bounds.max[5], 200);
}

TEST(GeneLayout, GroupsAreRangesOfAChromosome) {
    Parameters parameters;
    parameters.free_genes = 10;
    EXPECT_EQ(genes_of(GeneGroup::All, parameters), (GeneRange{0, 16}));
    EXPECT_EQ(genes_of(GeneGroup::Body, parameters), (GeneRange{0, 6}));
    EXPECT_EQ(genes_of(GeneGroup::Brain, parameters).count, 0u);
    EXPECT_EQ(genes_of(GeneGroup::Free, parameters), (GeneRange{6, 10}));
}

/// A world without bodies whose organisms a client rates.
Parameters optimiser(std::uint32_t free_genes) {
    Parameters parameters;
    parameters.fitness = FitnessFunction::External;
    parameters.external_bodies = false;
    parameters.free_genes = free_genes;
    return parameters;
}

TEST(GeneLayout, OptimisersHaveTheirFreeGenesAlone) {
    Parameters parameters = optimiser(2);
    parameters.controller = Controller::Network;
    const GeneLayout layout = gene_layout(parameters);
    EXPECT_EQ(layout.names, (std::vector<std::string>{"free0", "free1"}));
    EXPECT_EQ(layout.groups, (std::vector<GeneGroup>{GeneGroup::Free, GeneGroup::Free}));
    EXPECT_EQ(layout.bounds.max.size(), 2);
    EXPECT_EQ(gene_count(parameters), 2u);
    EXPECT_EQ(genes_of(GeneGroup::Free, parameters), (GeneRange{0, 2}));
    EXPECT_EQ(genes_of(GeneGroup::Body, parameters).count, 0u);
    parameters.external_bodies = true;
    EXPECT_EQ(genes_of(GeneGroup::Body, parameters).count, 6u);
    EXPECT_EQ(gene_layout(optimiser(0)).names.front(), "normal_speed") << "without free genes, a client rates these";
}

} // namespace
} // namespace evod::evolution
