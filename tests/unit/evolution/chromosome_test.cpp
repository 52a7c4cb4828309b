#include "server/evolution/chromosome.h"

#include "tests/unit/evolution/draws.h"

#include <gtest/gtest.h>

namespace evod::evolution {
namespace {

TEST(GeneBounds, FollowTheParametersInChromosomeOrder) {
    Parameters parameters;
    parameters.impulse_max = 300;
    parameters.body_size_min = 41;
    parameters.poison_radius_max = 199;
    const GeneBounds bounds = gene_bounds(parameters);
    EXPECT_EQ(bounds.max[Impulse], 300);
    EXPECT_EQ(bounds.min[BodySize], 41);
    EXPECT_EQ(bounds.max[PoisonRadius], 199);
    EXPECT_EQ(bounds.min[NormalSpeed], 20);
    EXPECT_EQ(bounds.max[BaseHealth], 200);
    EXPECT_EQ(bounds.min[FoodRadius], 20);
}

TEST(InitialPopulation, GenesAreUniformInTheirRange) {
    // Law: uniform over [80, 120]; chi-square over 40 cells, 39 degrees of freedom, for each gene.
    const GeneMatrix genes = initial_population(20'000, {}, base::Seed{111}, 0);
    for (unsigned gene = 0; gene < body_gene_count; ++gene) {
        std::vector<std::uint64_t> counts(40);
        for (Eigen::Index i = 0; i < genes.cols(); ++i) {
            ASSERT_GE(genes(gene, i), 80);
            ASSERT_LE(genes(gene, i), 120);
            ++counts[std::min<std::size_t>(39, static_cast<std::size_t>(genes(gene, i) - 80))];
        }
        EXPECT_GT(support::p_value_of_equal_cells(counts), alpha) << body_gene_names[gene];
    }
}

TEST(InitialPopulation, DoesNotDependOnThePopulationSize) {
    const GeneMatrix genes = initial_population(50, {}, base::Seed{112}, 3);
    EXPECT_TRUE((genes == initial_population(50, {}, base::Seed{112}, 3)).all());
    EXPECT_FALSE((genes == initial_population(50, {}, base::Seed{113}, 3)).any());
    EXPECT_FALSE((genes == initial_population(50, {}, base::Seed{112}, 4)).any());
    EXPECT_TRUE((genes.leftCols(7) == initial_population(7, {}, base::Seed{112}, 3)).all());
    EXPECT_EQ(initial_population(0, {}, base::Seed{112}, 3).cols(), 0);
}

TEST(InitialPopulation, StaysWithinTheBounds) {
    Parameters parameters;
    parameters.body_size_max = 90;
    parameters.food_radius_min = 110;
    const GeneMatrix genes = initial_population(100, parameters, base::Seed{114}, 0);
    EXPECT_TRUE((genes.row(BodySize) <= 90).all());
    EXPECT_TRUE((genes.row(BodySize) == 90).any());
    EXPECT_TRUE((genes.row(FoodRadius) >= 110).all());
}

TEST(InitialPopulation, FreeGenesAreUniformInTheirBounds) {
    // Law: uniform over [−2, 3]; chi-square over 50 cells, 49 degrees of freedom, for each gene.
    Parameters parameters;
    parameters.free_genes = 7;
    parameters.free_gene_min = -2;
    parameters.free_gene_max = 3;
    const GeneMatrix genes = initial_population(20'000, parameters, base::Seed{115}, 0);
    ASSERT_EQ(genes.rows(), 13);
    EXPECT_TRUE((genes.topRows(6).leftCols(1) == initial_population(1, {}, base::Seed{115}, 0)).all());
    for (unsigned gene = 6; gene < 13; ++gene) {
        std::vector<std::uint64_t> counts(50);
        for (Eigen::Index i = 0; i < genes.cols(); ++i) {
            ASSERT_GE(genes(gene, i), -2);
            ASSERT_LE(genes(gene, i), 3);
            ++counts[std::min<std::size_t>(49, static_cast<std::size_t>((genes(gene, i) + 2) * 10))];
        }
        EXPECT_GT(support::p_value_of_equal_cells(counts), alpha) << gene;
    }
}

TEST(Clamp, CountsEveryGeneThatItMoves) {
    const GeneBounds bounds = gene_bounds({});
    std::array<float, body_gene_count> genes = {19, 250, 200, 201, 20, 1e30f};
    EXPECT_EQ(clamp(Genes{genes}, bounds), 3u);
    EXPECT_EQ(genes, (std::array<float, body_gene_count>{20, 250, 200, 200, 20, 200}));
    EXPECT_EQ(clamp(Genes{genes}, bounds), 0u);
}

} // namespace
} // namespace evod::evolution
