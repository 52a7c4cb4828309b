#include "server/evolution/breeding_loops.h"
#include "tests/unit/evolution/draws.h"
#include "tests/unit/evolution/stage_choices.h"

#include <gtest/gtest.h>

namespace evod::evolution {
namespace {

TEST(WideChromosomes, OfSixGenesBreedAsTheFixedOnes) {
    base::InlineExecutor executor;
    const BreedingKey key{.seed = base::Seed{231}, .island = 1, .generation = 4};
    for (const StageChoice& choice : stage_choices()) {
        const GeneMatrix genes = initial_population(200, choice, base::Seed{232}, 0);
        std::vector<double> fitness;
        for (std::uint32_t i = 0; i < 200; ++i) {
            fitness.push_back(stream_of(233, i).below(100));
        }
        const NextGeneration fixed = next_generation(fitness, genes, choice, 150, key, executor);
        NextGeneration wide{.genes = GeneMatrix(6, 150),
                            .parents = std::vector<Parents>(150),
                            .elite_count = fixed.elite_count,
                            .survivor_count = fixed.survivor_count};
        Ranking ranking{fitness, executor};
        fill_wide(wide, choose(ranking, choice, 150, key, executor), genes, choice, key, executor);
        EXPECT_TRUE((fixed.genes == wide.genes).all()) << choice.name;
        EXPECT_EQ(fixed.parents, wide.parents) << choice.name;
        EXPECT_EQ(fixed.clamped_count, wide.clamped_count) << choice.name;
    }
}

TEST(WideChromosomes, MutateOnlyTheGroupInItsSteps) {
    Parameters parameters;
    parameters.free_genes = 322;
    parameters.mutation_chance = 1;
    parameters.free_mutation_step = 0.01;
    parameters.mutate_group = GeneGroup::Free;
    const ValueMutation<> mutation{parameters};
    std::vector<float> genes(328, 0.5f);
    std::fill(genes.begin(), genes.begin() + 6, 100.0f);
    base::RandomStream random = stream_of(234);
    EXPECT_EQ(mutation.apply(genes, random), 0u);
    for (unsigned gene = 0; gene < 328; ++gene) {
        if (gene < 6) {
            EXPECT_EQ(genes[gene], 100);
        } else {
            EXPECT_NE(genes[gene], 0.5f);
            EXPECT_NEAR(genes[gene], 0.5f, 0.0101);
        }
    }
}

/// A generation that is bred from chromosomes of free genes, whose parents are drawn at random.
NextGeneration bred(Parameters parameters, const GeneMatrix& genes) {
    parameters.fitness = FitnessFunction::External;
    parameters.external_bodies = false;
    parameters.free_genes = static_cast<std::uint32_t>(genes.rows());
    parameters.population_model = PopulationModel::Generational;
    parameters.selection = SelectionMethod::Random;
    base::InlineExecutor executor;
    return next_generation(std::vector<double>(static_cast<std::size_t>(genes.cols())), genes, parameters,
                           static_cast<std::uint32_t>(genes.cols()), {.seed = base::Seed{235}, .generation = 1},
                           executor);
}

/// Every gene of organism i is i / 1000.
GeneMatrix numbered(Eigen::Index genes, Eigen::Index organisms) {
    GeneMatrix numbered(genes, organisms);
    for (Eigen::Index organism = 0; organism < organisms; ++organism) {
        numbered.col(organism) = static_cast<float>(organism) / 1000;
    }
    return numbered;
}

TEST(FreeGenesAlone, ASinglePointIsBetweenThem) {
    Parameters parameters;
    parameters.crossover = CrossoverMethod::SinglePoint;
    parameters.crossover_chance = 0.5;
    parameters.mutation_chance = 0;
    const NextGeneration next = bred(parameters, numbered(2, 1000));
    int mixed = 0;
    for (std::uint32_t child = 0; child < 1000; ++child) {
        mixed += next.genes(0, child) != next.genes(1, child);
    }
    EXPECT_GT(mixed, 400); // half of the pairs mix their genes: 500 children, standard deviation 22
    EXPECT_LT(mixed, 600);
}

TEST(FreeGenesAlone, MayBeFewerThanTheCuts) {
    for (const Eigen::Index genes : {1, 2, 3}) {
        for (const CrossoverMethod crossover : {CrossoverMethod::SinglePoint, CrossoverMethod::MultiPoint}) {
            Parameters parameters;
            parameters.crossover = crossover;
            parameters.crossover_cuts = 5;
            parameters.rearranging = OrderMutationMethod::Swap;
            parameters.rearrange_chance = 1;
            const NextGeneration next = bred(parameters, numbered(genes, 20));
            EXPECT_EQ(next.genes.rows(), genes);
            EXPECT_TRUE((next.genes >= 0).all());
        }
    }
}

TEST(FreeGenesAlone, SixOfAListStayAPermutation) {
    Parameters parameters;
    parameters.mutation_chance = parameters.rearrange_chance = 1;
    parameters.rearranging = OrderMutationMethod::Inversion;
    FreeGene tour;
    tour.kind = FreeGene::Kind::Permutation;
    tour.count = 6;
    parameters.listed_genes = FreeGenes{{tour}};
    GeneMatrix genes(6, 50);
    genes.colwise() = Eigen::ArrayXf::LinSpaced(6, 0, 5);
    const NextGeneration next = bred(parameters, genes);
    EXPECT_FALSE((next.genes == genes).all());
    for (auto order : next.genes.colwise()) {
        std::vector<float> sorted(order.begin(), order.end());
        std::ranges::sort(sorted);
        EXPECT_EQ(sorted, (std::vector<float>{0, 1, 2, 3, 4, 5}));
    }
}

} // namespace
} // namespace evod::evolution
