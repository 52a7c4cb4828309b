#include "server/simulation/founders.h"

#include <gtest/gtest.h>

namespace evod::simulation {
namespace {

constexpr base::Seed seed{7};

parameters::Parameters three_places(std::uint32_t islands = 1) {
    parameters::Parameters parameters;
    parameters.population_size = 3;
    parameters.island_count = islands;
    return parameters;
}

/// One island whose organisms have the genes 100, 101, …
FirstPopulation organisms(Eigen::Index count) {
    evolution::GeneMatrix genes{evolution::body_gene_count, count};
    for (Eigen::Index organism = 0; organism < count; ++organism) {
        genes.col(organism) = 100 + static_cast<float>(organism);
    }
    return std::make_shared<const std::vector<evolution::GeneMatrix>>(1, genes);
}

TEST(Founders, TheSeedFillsPlacesAsWithoutAPopulation) {
    const auto filled = completed(organisms(2), three_places(2), seed);
    ASSERT_EQ(filled->size(), 2u);
    EXPECT_EQ((*filled)[0](0, 1), 101);
    const auto first = evolution::initial_population(3, three_places(2), seed, 0);
    const auto second = evolution::initial_population(3, three_places(2), seed, 1);
    EXPECT_TRUE(((*filled)[0].col(2) == first.col(2)).all());
    EXPECT_TRUE(((*filled)[1] == second).all());
}

TEST(Founders, ClonesAreCopiedInTurn) {
    const auto filled = completed(organisms(2), three_places(), seed, Filling::Clones);
    EXPECT_EQ((*filled)[0](0, 2), 100);
    EXPECT_EQ((*filled)[0](0, 1), 101);
}

TEST(Founders, OtherPopulationsAreUnchanged) {
    EXPECT_EQ(completed(nullptr, three_places(), seed), nullptr);
    for (const Eigen::Index count : {3, 4}) {
        const FirstPopulation given = organisms(count);
        EXPECT_EQ(completed(given, three_places(), seed), given);
    }
    const auto two_islands = std::make_shared<const std::vector<evolution::GeneMatrix>>(2, organisms(1)->front());
    EXPECT_EQ(completed(two_islands, three_places(), seed), two_islands);
}

} // namespace
} // namespace evod::simulation
