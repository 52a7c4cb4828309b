#include "server/evolution/next_generation.h"

#include "server/base/state_hash.h"
#include "server/evolution/ranking.h"
#include "server/evolution/shuffle.h"
#include "server/jobs/thread_pool.h"
#include "tests/unit/evolution/draws.h"
#include "tests/unit/evolution/stage_choices.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace evod::evolution {
namespace {

struct Population {
    std::vector<double> fitness;
    GeneMatrix genes;
};

/// Organism i has distinct genes; fitness is drawn, with ties.
Population population_of(std::uint32_t count, std::uint64_t seed) {
    base::RandomStream random = stream_of(seed);
    Population population{{}, initial_population(count, {}, base::Seed{seed}, 0)};
    for (std::uint32_t i = 0; i < count; ++i) {
        population.fitness.push_back(random.below(100) / 4.0);
    }
    return population;
}

NextGeneration breed(const Population& population, const Parameters& parameters, std::uint32_t wanted,
                     std::uint64_t seed = 221, std::uint64_t generation = 1) {
    base::InlineExecutor executor;
    return next_generation(population.fitness, population.genes, parameters, wanted,
                           {.seed = base::Seed{seed}, .island = 0, .generation = generation}, executor);
}

/// Children are then exact mixtures of their parents.
Parameters without_mutation() {
    Parameters parameters;
    parameters.mutation_chance = 0;
    return parameters;
}

/// The set of parents, in any order.
std::pair<std::uint32_t, std::uint32_t> pair_of(const Parents& parents) {
    return std::minmax({parents.first, parents.second});
}

constexpr PopulationModel all_models[] = {PopulationModel::Hybrid, PopulationModel::Generational,
                                          PopulationModel::SteadyState, PopulationModel::Nsga2};

TEST(Places, HybridKeepsItsShareRoundedAndAtLeastOne) {
    Parameters parameters;
    const auto survivors = [&](std::uint32_t wanted) { return share_places(50, wanted, parameters).survivors; };
    EXPECT_EQ(survivors(1), 1u);
    EXPECT_EQ(survivors(2), 1u);
    EXPECT_EQ(survivors(3), 2u);
    EXPECT_EQ(survivors(50), 25u);
    EXPECT_EQ(survivors(51), 26u);
    parameters.survivors = 0;
    EXPECT_EQ(survivors(50), 1u);
    parameters.survivors = 1;
    EXPECT_EQ(survivors(50), 50u);
    EXPECT_EQ(survivors(80), 80u);
    parameters.survivors = 0.3;
    EXPECT_EQ(survivors(4'000'000), 1'200'000u);
}

TEST(Places, GenerationalKeepsOnlyTheElite) {
    Parameters parameters;
    parameters.population_model = PopulationModel::Generational;
    EXPECT_EQ(share_places(50, 50, parameters).survivors, 0u);
    parameters.elite_count = 3;
    EXPECT_EQ(share_places(50, 50, parameters).survivors, 3u);
    EXPECT_EQ(share_places(50, 50, parameters).children, 47u);
}

TEST(Places, SteadyStateAddsChildrenAndDropsTheWorst) {
    Parameters parameters;
    parameters.population_model = PopulationModel::SteadyState;
    parameters.replaced_count = 5;
    const auto survivors = [&](std::uint32_t present, std::uint32_t wanted) {
        return share_places(present, wanted, parameters).survivors;
    };
    EXPECT_EQ(survivors(20, 20), 15u);
    EXPECT_EQ(survivors(20, 30), 15u);
    EXPECT_EQ(survivors(20, 12), 7u);
    EXPECT_EQ(survivors(5, 5), 0u);
    EXPECT_EQ(survivors(3, 3), 0u);
    EXPECT_EQ(survivors(1, 1), 0u);
    parameters.elite_count = 2;
    EXPECT_EQ(survivors(5, 5), 2u);
}

TEST(Places, TheEliteIsAtMostThePopulation) {
    for (const PopulationModel model : all_models) {
        Parameters parameters;
        parameters.population_model = model;
        parameters.elite_count = 1000;
        for (const auto& [present, wanted] : {std::pair{10u, 10u}, {10u, 4u}, {10u, 30u}, {1u, 1u}}) {
            const Places places = share_places(present, wanted, parameters);
            EXPECT_EQ(places.elite, std::min(present, wanted));
            EXPECT_GE(places.survivors, places.elite);
            EXPECT_EQ(places.survivors + places.children, wanted);
        }
    }
}

TEST(NextGeneration, HasTheWantedSizeAndParentsForAll) {
    for (const Parameters& choice : stage_choices()) {
        for (const std::uint32_t present : {1u, 2u, 3u, 4u, 5u, 7u, 20u}) {
            for (const std::uint32_t wanted : {1u, 2u, 3u, 5u, 7u, 8u, 20u, 33u}) {
                Parameters parameters = choice;
                for (const std::uint32_t elite_count : {0u, 1u, 4u}) {
                    parameters.elite_count = elite_count;
                    const Population population = population_of(present, 222);
                    const NextGeneration next = breed(population, parameters, wanted);
                    const Places places = share_places(present, wanted, parameters);
                    ASSERT_EQ(next.genes.cols(), wanted);
                    ASSERT_EQ(next.parents.size(), wanted);
                    ASSERT_EQ(next.elite_count, places.elite);
                    ASSERT_EQ(next.survivor_count, places.survivors);
                    for (std::uint32_t i = 0; i < wanted; ++i) {
                        ASSERT_LT(next.parents[i].first, present);
                        ASSERT_LT(next.parents[i].second, present);
                        ASSERT_TRUE(i >= next.survivor_count || next.parents[i].first == next.parents[i].second);
                    }
                    const GeneBounds bounds = gene_bounds(parameters);
                    for (std::uint32_t i = 0; i < wanted; ++i) {
                        ASSERT_TRUE((next.genes.col(i) >= bounds.min).all());
                        ASSERT_TRUE((next.genes.col(i) <= bounds.max).all());
                    }
                }
            }
        }
    }
}

TEST(NextGeneration, SurvivorsAreCopiedUnchanged) {
    for (const PopulationModel model : all_models) {
        Parameters parameters;
        parameters.population_model = model;
        parameters.elite_count = 2;
        const Population population = population_of(31, 223);
        const NextGeneration next = breed(population, parameters, 31);
        for (std::uint32_t i = 0; i < next.survivor_count; ++i) {
            EXPECT_TRUE((next.genes.col(i) == population.genes.col(next.parents[i].first)).all());
        }
    }
}

TEST(NextGeneration, MutatedSurvivorsChangeButTheEliteDoesNot) {
    Parameters parameters;
    parameters.mutate_survivors = true;
    parameters.mutation_chance = 1;
    parameters.elite_count = 4;
    const Population population = population_of(40, 224);
    const NextGeneration next = breed(population, parameters, 40);
    ASSERT_EQ(next.survivor_count, 20u);
    for (std::uint32_t i = 0; i < next.survivor_count; ++i) {
        const auto parent = population.genes.col(next.parents[i].first);
        EXPECT_EQ((next.genes.col(i) == parent).all(), i < 4);
        EXPECT_TRUE(((next.genes.col(i) - parent).abs() <= 15.001f).all());
    }
}

TEST(NextGeneration, SurvivorsMutateByTheSameLawAsChildren) {
    // Law: each gene mutates with probability 0.15. Chi-square, 1 degree of freedom.
    Parameters parameters;
    parameters.mutate_survivors = true;
    const Population population = population_of(100'000, 225);
    const NextGeneration next = breed(population, parameters, 100'000);
    std::vector<std::uint64_t> counts(2);
    for (std::uint32_t i = 0; i < next.survivor_count; ++i) {
        for (unsigned gene = 0; gene < body_gene_count; ++gene) {
            ++counts[next.genes(gene, i) != population.genes(gene, next.parents[i].first)];
        }
    }
    // A step rounds to the same float with probability below 1e-6.
    EXPECT_GT(p_value_of_law(counts, std::vector{0.85, 0.15}), alpha);
}

TEST(NextGeneration, TheEliteComesFirstBestFirst) {
    for (const PopulationModel model : all_models) {
        for (const SelectionMethod method :
             {SelectionMethod::Roulette, SelectionMethod::Random, SelectionMethod::Truncation}) {
            Parameters parameters;
            parameters.population_model = model;
            parameters.selection = method;
            parameters.elite_count = 5;
            const Population population = population_of(23, 226);
            Ranking ranking{population.fitness};
            const NextGeneration next = breed(population, parameters, 23);
            ASSERT_EQ(next.elite_count, 5u);
            for (std::uint32_t i = 0; i < 5; ++i) {
                EXPECT_EQ(next.parents[i].first, ranking.best_first()[i]);
            }
        }
    }
}

TEST(NextGeneration, AnElitePickedByTheSelectionUsesUpThatPick) {
    Parameters parameters;
    parameters.selection = SelectionMethod::Truncation;
    const Population population = population_of(20, 227);
    const NextGeneration plain = breed(population, parameters, 20);
    parameters.elite_count = 3;
    const NextGeneration with_elite = breed(population, parameters, 20);
    for (std::uint32_t i = 0; i < 10; ++i) { // truncation keeps the ten best either way, each once
        EXPECT_EQ(with_elite.parents[i], plain.parents[i]);
    }
}

TEST(NextGeneration, HybridSurvivorsAreTheOnlyParents) {
    for (const SelectionMethod method : {SelectionMethod::Roulette, SelectionMethod::Tournament}) {
        Parameters parameters;
        parameters.selection = method;
        const Population population = population_of(50, 228);
        const NextGeneration next = breed(population, parameters, 50);
        std::vector<bool> survives(50);
        for (std::uint32_t i = 0; i < next.survivor_count; ++i) {
            survives[next.parents[i].first] = true;
        }
        for (std::uint32_t i = next.survivor_count; i < 50; ++i) {
            EXPECT_TRUE(survives[next.parents[i].first]);
            EXPECT_TRUE(survives[next.parents[i].second]);
        }
    }
}

TEST(Places, Nsga2KeepsItsShareOfThoseThatAreThere) {
    Parameters parameters;
    parameters.population_model = PopulationModel::Nsga2;
    EXPECT_EQ(share_places(50, 51, parameters).survivors, 26u);
    EXPECT_EQ(share_places(7, 50, parameters).survivors, 7u);
    parameters.survivors = 0;
    EXPECT_EQ(share_places(50, 50, parameters).survivors, 1u);
    parameters.elite_count = 3;
    EXPECT_EQ(share_places(50, 50, parameters).survivors, 3u);
}

TEST(NextGeneration, Nsga2KeepsTheBestAndBreedsFromThem) {
    for (const SelectionMethod method :
         {SelectionMethod::Roulette, SelectionMethod::StochasticUniversal, SelectionMethod::Tournament,
          SelectionMethod::Random, SelectionMethod::Truncation}) {
        Parameters parameters;
        parameters.population_model = PopulationModel::Nsga2;
        parameters.selection = method;
        parameters.survivors = 0.3;
        parameters.elite_count = 2;
        const Population population = population_of(60, 234);
        const auto best = Ranking{population.fitness}.best_fitness(18);
        const NextGeneration next = breed(population, parameters, 60);
        ASSERT_EQ(next.survivor_count, 18u);
        std::vector<bool> survives(60);
        std::vector<double> kept;
        for (std::uint32_t i = 0; i < 18; ++i) {
            survives[next.parents[i].first] = true;
            kept.push_back(population.fitness[next.parents[i].first]);
        }
        EXPECT_EQ(kept[0], best[0]);
        EXPECT_EQ(kept[1], best[1]);
        std::ranges::sort(kept, std::ranges::greater{});
        EXPECT_EQ(kept, best);
        EXPECT_EQ(std::ranges::count(survives, true), 18);
        for (std::uint32_t i = 18; i < 60; ++i) {
            EXPECT_TRUE(survives[next.parents[i].first] && survives[next.parents[i].second]);
        }
    }
}

TEST(NextGeneration, SteadyStateLosesTheWorstAndKeepsTheOthersInOrder) {
    Parameters parameters;
    parameters.population_model = PopulationModel::SteadyState;
    parameters.replaced_count = 3;
    const Population population{{5, 1, 4, 1, 3, 2, 1}, initial_population(7, {}, base::Seed{229}, 0)};
    const NextGeneration next = breed(population, parameters, 7);
    ASSERT_EQ(next.survivor_count, 4u);
    for (std::uint32_t i = 0; const std::uint32_t kept : {0u, 2u, 4u, 5u}) {
        EXPECT_EQ(next.parents[i++].first, kept);
    }
}

TEST(NextGeneration, SteadyStateParentsAreDrawnFromAllTheWorstIncluded) {
    Parameters parameters;
    parameters.population_model = PopulationModel::SteadyState;
    parameters.replaced_count = 4;
    parameters.selection = SelectionMethod::Random;
    const Population population{{5, 4, 3, 0, 0, 0, 0}, initial_population(7, {}, base::Seed{230}, 0)};
    std::vector<std::uint64_t> bred(7);
    for (std::uint64_t seed = 0; seed < 10'000; ++seed) {
        const NextGeneration next = breed(population, parameters, 7, seed);
        for (std::uint32_t i = next.survivor_count; i < 7; i += 2) { // both children of a pair have the same two
                                                                     // parents
            ++bred[next.parents[i].first];
            ++bred[next.parents[i].second];
        }
    }
    // Law: uniform over the population. The four parents of a generation are different, so the counts vary less than
    // the test assumes. Chi-square, 6 degrees of freedom.
    EXPECT_GT(support::p_value_of_equal_cells(bred), alpha);
}

TEST(NextGeneration, ASingleReplacementHasTwoParents) {
    Parameters parameters;
    parameters.population_model = PopulationModel::SteadyState;
    parameters.replaced_count = 1;
    parameters.selection = SelectionMethod::Random;
    const NextGeneration next = breed(population_of(10, 231), parameters, 10);
    EXPECT_EQ(next.survivor_count, 9u);
    EXPECT_NE(next.parents[9].first, next.parents[9].second);
}

TEST(NextGeneration, GenerationalTruncationBreedsFromTheBestShareAlone) {
    Parameters parameters;
    parameters.population_model = PopulationModel::Generational;
    parameters.selection = SelectionMethod::Truncation;
    parameters.survivors = 0.2;
    const Population population = population_of(50, 232);
    Ranking ranking{population.fitness};
    const auto best = ranking.best_first().first(10);
    std::map<std::uint32_t, std::uint32_t> bred;
    for (const Parents& parents : breed(population, parameters, 50).parents) {
        ++bred[parents.first];
        ++bred[parents.second];
    }
    ASSERT_EQ(bred.size(), 10u);
    for (const auto& [organism, times] : bred) {
        EXPECT_NE(std::ranges::find(best, organism), best.end());
        EXPECT_EQ(times, 10u);
    }
}

TEST(NextGeneration, ChildrenAreComplementaryMixturesOfTheirParents) {
    Population population = population_of(60, 233);
    const NextGeneration next = breed(population, without_mutation(), 60);
    for (std::uint32_t i = next.survivor_count; i + 1 < 60; i += 2) {
        ASSERT_EQ(pair_of(next.parents[i]), pair_of(next.parents[i + 1]));
        for (unsigned gene = 0; gene < body_gene_count; ++gene) {
            const float a = population.genes(gene, next.parents[i].first);
            const float b = population.genes(gene, next.parents[i].second);
            const float child = next.genes(gene, i), sibling = next.genes(gene, i + 1);
            EXPECT_TRUE((child == a && sibling == b) || (child == b && sibling == a));
        }
    }
}

TEST(NextGeneration, BlendedSiblingsKeepTheMeanOfTheirParents) {
    Parameters parameters = without_mutation();
    parameters.crossover = CrossoverMethod::Blend;
    const Population population = population_of(400, 244);
    const NextGeneration next = breed(population, parameters, 400);
    for (std::uint32_t i = next.survivor_count; i + 1 < 400; i += 2) {
        const auto [first, second] = next.parents[i];
        ASSERT_EQ(next.parents[i + 1], (Parents{second, first}));
        double share = -1; // the weight of the second parent, the same in every gene
        for (unsigned gene = 0; gene < body_gene_count; ++gene) {
            const double a = double{population.genes(gene, first)}, b = double{population.genes(gene, second)};
            const double child = double{next.genes(gene, i)}, sibling = double{next.genes(gene, i + 1)};
            ASSERT_LE(std::abs(child + sibling - (a + b)), 0x1p-23 * std::max(a, b));
            ASSERT_LE(std::abs(child - a), std::abs(child - b)) << "the first parent has the larger weight";
            if (std::abs(b - a) > 1) {
                const double own = (child - a) / (b - a);
                ASSERT_NEAR(share < 0 ? own : share, own, 1e-4);
                share = own;
            }
        }
    }
}

TEST(NextGeneration, BlendKeepsTwoThirdsOfTheVariance) {
    // Law: E(w² + (1 − w)²) = 2/3 for w uniform in (0, 1). With 100,000 pairs of children, the standard error of the
    // ratio is below 0.003; the test allows five standard errors.
    Parameters parameters = without_mutation();
    parameters.crossover = CrossoverMethod::Blend;
    parameters.population_model = PopulationModel::Generational;
    parameters.selection = SelectionMethod::Random;
    const Population population = population_of(200'000, 245);
    const NextGeneration next = breed(population, parameters, 200'000);
    for (unsigned gene = 0; gene < body_gene_count; ++gene) {
        const auto variance = [&](const GeneMatrix& genes) {
            const auto row = genes.row(gene).cast<double>();
            return (row - row.mean()).square().mean();
        };
        EXPECT_NEAR(variance(next.genes) / variance(population.genes), 2.0 / 3, 0.015);
    }
}

TEST(NextGeneration, TheFirstParentGaveMostGenes) {
    const Population population = population_of(401, 242);
    for (const CrossoverMethod method :
         {CrossoverMethod::Uniform, CrossoverMethod::SinglePoint, CrossoverMethod::MultiPoint, CrossoverMethod::None}) {
        for (const double chance : {0.0, 0.5, 1.0}) {
            Parameters parameters = without_mutation();
            parameters.crossover = method;
            parameters.crossover_chance = chance;
            const NextGeneration next = breed(population, parameters, 401);
            for (std::uint32_t i = next.survivor_count; i < 401; ++i) {
                const auto [first, second] = next.parents[i];
                if (first == second) {
                    continue;
                }
                const auto of_first = (next.genes.col(i) == population.genes.col(first)).count();
                ASSERT_GE(of_first, 3) << "child " << i;
                ASSERT_EQ((next.genes.col(i) == population.genes.col(second)).count(), 6 - of_first);
                ASSERT_TRUE(of_first == 6 || (chance > 0 && method != CrossoverMethod::None));
            }
        }
    }
}

TEST(NextGeneration, SiblingsWithHalfOfEachShareTheFirstParent) {
    const Population population = population_of(400, 243);
    const NextGeneration next = breed(population, without_mutation(), 400);
    std::uint32_t halves = 0;
    for (std::uint32_t i = next.survivor_count; i + 1 < 400; i += 2) {
        const auto [first, second] = next.parents[i];
        if (first != second && (next.genes.col(i) == population.genes.col(first)).count() == 3) {
            EXPECT_EQ(next.parents[i], next.parents[i + 1]);
            ++halves;
        } else if (first != second) {
            EXPECT_EQ(next.parents[i + 1], (Parents{second, first}));
        }
    }
    EXPECT_GT(halves, 10u); // of 100 pairs, each with probability 20 / 64
}

TEST(NextGeneration, SurplusChildrenAreDroppedLastFirst) {
    // Eight parents make four pairs; with seven children, the second child of the last pair is missing.
    Parameters parameters;
    parameters.population_model = PopulationModel::SteadyState;
    parameters.selection = SelectionMethod::Truncation;
    parameters.replaced_count = 8;
    const Population population = population_of(20, 234);
    const NextGeneration even = breed(population, parameters, 20);
    parameters.replaced_count = 7;
    const NextGeneration odd = breed(population, parameters, 20);
    EXPECT_EQ(even.survivor_count, 12u);
    EXPECT_EQ(odd.survivor_count, 13u);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> children;
    for (std::uint32_t i = 13; i < 20; ++i) {
        ++children[pair_of(odd.parents[i])];
    }
    EXPECT_EQ(pair_of(odd.parents[13]), pair_of(odd.parents[14]));
    EXPECT_EQ(pair_of(odd.parents[17]), pair_of(odd.parents[18]));
    EXPECT_EQ(children.size(), 4u);
}

TEST(NextGeneration, ClampedGenesAreCounted) {
    Parameters parameters = without_mutation();
    const Population population = population_of(50, 235); // genes in 80 … 120
    EXPECT_EQ(breed(population, parameters, 50).clamped_count, 0u);
    parameters.base_health_max = 80; // every organism's gene is above it: the new bounds hold for all
    const NextGeneration next = breed(population, parameters, 50);
    EXPECT_EQ(next.clamped_count, 50u);
    EXPECT_TRUE((next.genes.row(BaseHealth) == 80).all());
}

TEST(NextGeneration, EverySeedIslandAndGenerationBreedsDifferently) {
    const Population population = population_of(30, 236);
    base::InlineExecutor executor;
    const auto bred = [&](BreedingKey key) {
        return next_generation(population.fitness, population.genes, {}, 30, key, executor).genes;
    };
    const GeneMatrix reference = bred({base::Seed{1}, 2, 3});
    EXPECT_TRUE((reference == bred({base::Seed{1}, 2, 3})).all());
    EXPECT_FALSE((reference == bred({base::Seed{2}, 2, 3})).all());
    EXPECT_FALSE((reference == bred({base::Seed{1}, 3, 3})).all());
    EXPECT_FALSE((reference == bred({base::Seed{1}, 2, 4})).all());
}

TEST(NextGeneration, HasItsGoldenHash) {
    // The same for every compiler and optimisation level. A change of this hash changes the result of every seed, so
    // the commit must give the reason.
    base::StateHash hash, hash_of_later;
    std::uint64_t id = 0, id_of_later = 0;
    const Population population = population_of(1000, 240);
    for (const Parameters& parameters : stage_choices()) {
        // Choices that were added later have a hash of their own, so that the first hash does not change.
        const bool later =
            parameters.population_model == PopulationModel::Nsga2 || parameters.crossover == CrossoverMethod::Blend ||
            parameters.crossover == CrossoverMethod::SimulatedBinary || parameters.creep == Creep::Polynomial ||
            parameters.scale_chance > 0 || parameters.out_of_bounds != OutOfBounds::Clamp;
        const NextGeneration next = breed(population, parameters, 1001);
        for (std::uint32_t i = 0; i < 1001; ++i) {
            base::EntityHash entity{0, later ? id_of_later++ : id++};
            for (unsigned gene = 0; gene < body_gene_count; gene += 2) {
                entity.add(next.genes(gene, i), next.genes(gene + 1, i));
            }
            (later ? hash_of_later : hash) += entity.add(next.parents[i].first, next.parents[i].second).finish();
        }
    }
    EXPECT_EQ(base::to_text(hash), "6a6ad3dec19d4d1d881facd1eaf6957b");
    EXPECT_EQ(base::to_text(hash_of_later), "cd0140ad23d7af4dfa6dd1bf17e83c9b");
}

class SameBitsOnAnyThreadCount : public testing::TestWithParam<std::size_t> {};

TEST_P(SameBitsOnAnyThreadCount, ForEveryChoiceOfEveryStage) {
    jobs::ThreadPool executor{GetParam()};
    const Population population = population_of(9001, 237);
    for (const Parameters& parameters : stage_choices()) {
        const NextGeneration reference = breed(population, parameters, 9003, 5, 6);
        const NextGeneration next = next_generation(population.fitness, population.genes, parameters, 9003,
                                                    {.seed = base::Seed{5}, .island = 0, .generation = 6}, executor);
        ASSERT_TRUE((next.genes == reference.genes).all());
        ASSERT_EQ(next.parents, reference.parents);
        ASSERT_EQ(next.clamped_count, reference.clamped_count);
    }
}

TEST_P(SameBitsOnAnyThreadCount, AlsoForShufflesInParts) {
    jobs::ThreadPool executor{GetParam()};
    const Population population = population_of(2 * shuffled_whole_max + 9, 241);
    for (const StageChoice& choice : stage_choices()) {
        if (choice.population_model == PopulationModel::Hybrid && choice.selection == SelectionMethod::Roulette &&
            choice.fitness_scaling == FitnessScaling::None) {
            continue; // see above
        }
        const auto wanted = static_cast<std::uint32_t>(population.fitness.size()) + 1;
        const NextGeneration reference = breed(population, choice, wanted, 7, 8);
        const NextGeneration next = next_generation(population.fitness, population.genes, choice, wanted,
                                                    {.seed = base::Seed{7}, .island = 0, .generation = 8}, executor);
        ASSERT_TRUE((next.genes == reference.genes).all()) << choice.name;
        ASSERT_EQ(next.parents, reference.parents) << choice.name;
    }
}

INSTANTIATE_TEST_SUITE_P(Threads, SameBitsOnAnyThreadCount, testing::Values(1, 2, 3, 8, 13));

TEST(NextGeneration, TheSumOfTheGenesRisesToItsBound) {
    // A check of the whole: fitness = Σ genes is at most 1100 with the default bounds, and begins near 600.
    for (const PopulationModel model : all_models) {
        for (const SelectionMethod method : {SelectionMethod::Tournament, SelectionMethod::Truncation}) {
            Parameters parameters;
            parameters.population_model = model;
            parameters.selection = method;
            parameters.elite_count = 1;
            parameters.replaced_count = 20;
            Population population = population_of(100, 238);
            double best = 0;
            for (std::uint64_t generation = 1; generation <= 300; ++generation) {
                double least_best = best;
                best = 0;
                for (std::uint32_t i = 0; i < 100; ++i) {
                    double sum = 0;
                    for (const float gene : column(std::as_const(population.genes), i)) {
                        sum += gene;
                    }
                    population.fitness[i] = sum;
                    best = std::max(best, sum);
                }
                ASSERT_GE(best, least_best) << "the elite was lost in generation " << generation;
                population.genes = breed(population, parameters, 100, 239, generation).genes;
            }
            EXPECT_GT(best, 1095);
        }
    }
}

} // namespace
} // namespace evod::evolution
