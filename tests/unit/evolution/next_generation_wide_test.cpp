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

} // namespace
} // namespace evod::evolution
