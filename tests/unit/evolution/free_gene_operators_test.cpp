#include "server/evolution/free_gene_operators.h"

#include "server/evolution/breeding_record.h"
#include "server/evolution/next_generation.h"
#include "tests/unit/evolution/draws.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <cmath>
#include <set>

namespace evod::evolution {
namespace {

constexpr unsigned first = body_gene_count; // the first listed gene

FreeGene number(double min, double max, double step = 0, bool logarithmic = false) {
    FreeGene gene;
    gene.min = min;
    gene.max = max;
    gene.step = step;
    gene.logarithmic = logarithmic;
    return gene;
}
FreeGene choice(std::size_t count) {
    FreeGene gene;
    gene.kind = FreeGene::Kind::Choice;
    for (std::size_t i = 0; i < count; ++i) {
        gene.choices.push_back("choice " + std::to_string(i));
    }
    return gene;
}
FreeGene permutation(std::uint32_t count) {
    FreeGene gene;
    gene.kind = FreeGene::Kind::Permutation;
    gene.count = count;
    return gene;
}

/// Rules of these genes; nothing mutates.
Parameters with_genes(std::vector<FreeGene> genes) {
    for (std::size_t i = 0; i < genes.size(); ++i) {
        genes[i].name = "gene" + std::to_string(i);
    }
    Parameters parameters;
    parameters.listed_genes = FreeGenes{std::move(genes)};
    parameters.free_genes = parameters.listed_genes.gene_count();
    parameters.mutation_chance = 0;
    parameters.mutate_group = GeneGroup::Free;
    return parameters;
}

std::vector<float> drawn(const Parameters& parameters, base::RandomStream& random) {
    std::vector<float> genes(gene_count(parameters), 100);
    FreeGeneOperators{parameters}.draw(Genes{genes}, random);
    return genes;
}

/// Calls `visit` with each of `count` mutants of chromosomes whose listed genes are uniform among their values.
template <class Visit>
void mutants(const Parameters& parameters, std::uint32_t count, std::uint64_t seed, const Visit& visit) {
    const FreeGeneOperators operators{parameters};
    for (std::uint32_t i = 0; i < count; ++i) {
        base::RandomStream random = stream_of(seed, i);
        std::vector<float> genes = drawn(parameters, random);
        const std::vector<float> before = genes;
        operators.mutate(Genes{genes}, random, SetGene{Genes{genes}});
        ASSERT_EQ(operators.first_fault(ConstGenes{genes}), std::nullopt);
        visit(before, genes);
    }
}

TEST(FreeGenes, EveryValueIsEquallyLikelyAtFirst) {
    // Law: uniform over 7 whole numbers, 5 choices, and over the logarithm of a number. Chi-square; the logarithm in 20
    // cells, 19 degrees of freedom.
    const Parameters parameters =
        with_genes({number(-3, 3, 1), choice(5), number(1e-4, 1e4, 0, true), number(0, 1, 0.25)});
    std::vector<std::uint64_t> whole(7), chosen(5), logarithm(20), quarters(5);
    for (std::uint32_t i = 0; i < 50'000; ++i) {
        base::RandomStream random = stream_of(300, i);
        const std::vector<float> genes = drawn(parameters, random);
        ++whole.at(static_cast<std::size_t>(genes[first] + 3));
        ++chosen.at(static_cast<std::size_t>(genes[first + 1]));
        ++logarithm.at(std::min<std::size_t>(19, static_cast<std::size_t>((std::log10(genes[first + 2]) + 4) * 2.5)));
        ++quarters.at(static_cast<std::size_t>(genes[first + 3] * 4));
    }
    for (const auto& counts : {whole, chosen, logarithm, quarters}) {
        EXPECT_GT(support::p_value_of_equal_cells(counts), alpha);
    }
}

TEST(FreeGenes, ALatinHypercubeHasOneOrganismInEachPart) {
    Parameters parameters = with_genes({number(10, 20), number(1e-3, 1e3, 0, true), number(1, 4, 1)});
    parameters.free_gene_start = FreeGeneStart::LatinHypercube;
    const GeneMatrix genes = initial_population(40, parameters, base::Seed{301}, 0);
    std::set<int> parts, logarithmic;
    std::vector<std::uint64_t> whole(4);
    for (int organism = 0; organism < 40; ++organism) {
        parts.insert(static_cast<int>((genes(first, organism) - 10) * 4));
        logarithmic.insert(static_cast<int>((std::log10(genes(first + 1, organism)) + 3) / 6 * 40));
        ++whole.at(static_cast<std::size_t>(genes(first + 2, organism) - 1));
    }
    EXPECT_EQ(parts.size(), 40u);
    EXPECT_EQ(logarithmic.size(), 40u);
    EXPECT_EQ(whole, std::vector<std::uint64_t>(4, 10));
    // Free genes without a list, too.
    Parameters unlisted;
    unlisted.free_genes = 2;
    unlisted.free_gene_start = FreeGeneStart::LatinHypercube;
    const GeneMatrix reals = initial_population(40, unlisted, base::Seed{302}, 0);
    std::set<int> cells;
    for (int organism = 0; organism < 40; ++organism) {
        cells.insert(static_cast<int>(reals(first, organism) * 40));
    }
    EXPECT_EQ(cells.size(), 40u);
}

TEST(FreeGenes, WholeNumbersKeepTheUniformLawIfTheyAreReflected) {
    // Law: whole numbers that are uniform stay so under every symmetric step. Chi-square, 8 degrees of freedom; for
    // steps that are smaller than 1, steps that reach beyond both bounds, normal steps, and resets.
    for (const auto& [share, creep, reset] :
         {std::tuple{0.01, Creep::Uniform, 0.0}, {3.0, Creep::Uniform, 0.0}, {0.3, Creep::Gaussian, 0.2}}) {
        Parameters parameters = with_genes({number(1, 9, 1)});
        parameters.mutation_chance = 1;
        parameters.free_mutation_step = share;
        parameters.creep = creep;
        parameters.reset_chance = reset;
        parameters.out_of_bounds = OutOfBounds::Reflect;
        std::vector<std::uint64_t> counts(9);
        std::uint64_t moved = 0;
        mutants(parameters, 50'000, 303, [&](const std::vector<float>& before, const std::vector<float>& after) {
            ++counts.at(static_cast<std::size_t>(after[first] - 1));
            moved += before[first] != after[first];
        });
        EXPECT_GT(support::p_value_of_equal_cells(counts), alpha) << share;
        EXPECT_GT(moved, 35'000u) << share; // a creep moves by one step at least; from an end, half return to it
    }
}

TEST(FreeGenes, RealNumbersKeepTheUniformLawIfTheyAreReflected) {
    // Law: uniform; of the logarithm for a logarithmic gene. Chi-square over 20 cells, 19 degrees of freedom.
    Parameters parameters = with_genes({number(-5, 15), number(0.01, 100, 0, true)});
    parameters.mutation_chance = 1;
    parameters.free_mutation_step = 0.4;
    parameters.out_of_bounds = OutOfBounds::Reflect;
    std::vector<std::uint64_t> real(20), logarithm(20);
    mutants(parameters, 50'000, 304, [&](const std::vector<float>&, const std::vector<float>& after) {
        ++real.at(std::min<std::size_t>(19, static_cast<std::size_t>(after[first] + 5)));
        ++logarithm.at(std::min<std::size_t>(19, static_cast<std::size_t>((std::log10(after[first + 1]) + 2) * 5)));
    });
    EXPECT_GT(support::p_value_of_equal_cells(real), alpha);
    EXPECT_GT(support::p_value_of_equal_cells(logarithm), alpha);
}

TEST(FreeGenes, AChoiceCreepsToEachOtherChoiceEquallyOften) {
    Parameters parameters = with_genes({choice(4)});
    parameters.mutation_chance = 1;
    std::vector<std::uint64_t> pairs(16);
    mutants(parameters, 50'000, 305, [&](const std::vector<float>& before, const std::vector<float>& after) {
        ++pairs.at(static_cast<std::size_t>(before[first] * 4 + after[first]));
    });
    std::vector<double> law(16, 1.0 / 12);
    law[0] = law[5] = law[10] = law[15] = 0;
    EXPECT_GT(p_value_of_law(pairs, law), alpha);
}

TEST(FreeGenes, AStepOfItsOwnIsTheSizeOfACreep) {
    FreeGene own = number(0, 1000);
    own.mutation_step = 2;
    Parameters parameters = with_genes({own, number(0, 1000)});
    parameters.mutation_chance = 1;
    parameters.free_mutation_step = 0.05; // 50 of 1000
    double largest_own = 0, largest = 0;
    mutants(parameters, 10'000, 306, [&](const std::vector<float>& before, const std::vector<float>& after) {
        largest_own = std::max(largest_own, std::abs(double{after[first]} - double{before[first]}));
        largest = std::max(largest, std::abs(double{after[first + 1]} - double{before[first + 1]}));
    });
    EXPECT_NEAR(largest_own, 2, 0.01);
    EXPECT_NEAR(largest, 50, 0.1);
}

TEST(OrderCrossover, FillsUpInTheOrderOfTheOtherParent) {
    // Goldberg's example, with elements from 0.
    const std::vector<float> near = {8, 7, 6, 4, 5, 3, 2, 0, 1, 9}, far = {7, 6, 0, 1, 2, 9, 8, 4, 3, 5};
    std::vector<float> child(10);
    cross_order(near, far, {3, 5}, child);
    // Behind the slice 4 5 3, `far` continues with 8, (4), (3), (5), 7, 6, 0, 1, 2, 9.
    EXPECT_EQ(child, (std::vector<float>{1, 2, 9, 4, 5, 3, 8, 7, 6, 0}));
}

RC_GTEST_PROP(OrderCrossover, KeepsPermutations, ()) {
    const auto count = *rc::gen::inRange(2u, 40u);
    const Parameters parameters = with_genes({number(0, 1), permutation(count), choice(3), permutation(5)});
    const FreeGeneOperators operators{parameters};
    const unsigned genes = gene_count(parameters);
    base::RandomStream random = stream_of(*rc::gen::arbitrary<std::uint64_t>());
    const std::vector<float> one = drawn(parameters, random), other = drawn(parameters, random);
    Parameters crossing = parameters;
    crossing.crossover = *rc::gen::element(CrossoverMethod::Uniform, CrossoverMethod::SinglePoint,
                                           CrossoverMethod::Blend, CrossoverMethod::SimulatedBinary);
    const Crossover<> crossover{crossing, genes};
    Mixture<> mixture{genes};
    RC_ASSERT(crossover.draw(mixture, random));
    operators.draw_slices(mixture, random);
    std::vector<float> child(genes);
    operators.cross(ConstGenes{one}, ConstGenes{other}, mixture.from_second, mixture, Genes{child});
    RC_ASSERT(operators.first_fault(ConstGenes{child}) == std::nullopt);
    // Equal parents have the same child.
    operators.cross(ConstGenes{one}, ConstGenes{one}, mixture.from_second, mixture, Genes{child});
    RC_ASSERT(std::ranges::equal(std::span{child}.subspan(first), std::span{one}.subspan(first)));
}

TEST(OrderCrossover, EachSliceIsEquallyLikely) {
    // Law: 1/10 for each of the pairs of 5 places. Chi-square, 9 degrees of freedom.
    const FreeGeneOperators operators{with_genes({permutation(5)})};
    std::vector<std::uint64_t> counts(25);
    for (std::uint32_t i = 0; i < 50'000; ++i) {
        base::RandomStream random = stream_of(307, i);
        Mixture<> mixture{first + 5};
        operators.draw_slices(mixture, random);
        ++counts.at(mixture.slices.at(0).first * 5 + mixture.slices.at(0).last);
    }
    std::vector<double> law(25);
    for (unsigned a = 0; a < 5; ++a) {
        for (unsigned b = a + 1; b < 5; ++b) {
            law[a * 5 + b] = 0.1;
        }
    }
    EXPECT_GT(p_value_of_law(counts, law), alpha);
}

TEST(FreeGenes, ValuesThatAreNotAllowedAreFound) {
    const FreeGeneOperators operators{
        with_genes({number(1, 3, 1), choice(2), permutation(3), number(0.1, 0.9), number(0, 1, 0.1)})};
    std::vector<float> genes = {100, 100, 100, 100, 100, 100, 2, 1, 2, 0, 1, 0.5f, 0.3f};
    EXPECT_EQ(operators.first_fault(ConstGenes{genes}), std::nullopt);
    for (const auto& [gene, value] : {std::pair{6, 2.5f}, {6, 4.0f}, {7, 2.0f}, {9, 2.0f}, {11, 0.05f}, {12, 0.35f}}) {
        std::vector<float> wrong = genes;
        wrong[static_cast<std::size_t>(gene)] = value;
        EXPECT_EQ(operators.first_fault(ConstGenes{wrong}), gene) << value;
    }
}

TEST(FreeGenes, BreedAsTheirRecordSays) {
    // The record of each descendant leads from the parents to the bred genes, which are all allowed.
    for (const CrossoverMethod method : {CrossoverMethod::Uniform, CrossoverMethod::Blend,
                                         CrossoverMethod::SimulatedBinary, CrossoverMethod::MultiPoint}) {
        Parameters parameters = with_genes(
            {number(0, 1), number(10, 90, 5), choice(3), permutation(8), number(1e-3, 10, 0, true), permutation(4)});
        parameters.mutate_group = GeneGroup::All;
        parameters.crossover = method;
        parameters.crossover_chance = 0.8;
        parameters.mutation_chance = 0.3;
        parameters.reset_chance = parameters.scale_chance = 0.1;
        parameters.bit_flip_chance = 0.02;
        parameters.rearranging = OrderMutationMethod::Inversion;
        parameters.rearrange_chance = 0.5;
        parameters.mutate_survivors = true;
        const GeneMatrix genes = initial_population(60, parameters, base::Seed{308}, 0);
        std::vector<double> fitness;
        for (int i = 0; i < 60; ++i) {
            fitness.push_back(i % 7);
        }
        base::InlineExecutor executor;
        const BreedingKey key{.seed = base::Seed{309}, .island = 0, .generation = 1};
        const NextGeneration next = next_generation(fitness, genes, parameters, 60, key, executor);
        const BreedingRecord record = record_breeding(fitness, genes, parameters, 60, key, {.count_max = 60}, executor);
        const FreeGeneOperators operators{parameters};
        unsigned reordered = 0;
        for (std::uint32_t i = 0; i < 60; ++i) {
            const auto& descendant = record.descendants.at(i);
            const ConstGenes bred = column(next.genes, i);
            ASSERT_EQ(operators.first_fault(bred), std::nullopt);
            ASSERT_TRUE(std::ranges::equal(bred, descendant.genes));
            std::vector<float> crossed = descendant.crossed_genes;
            for (unsigned gene = 0; gene < bred.size() && descendant.crossed_genes.empty(); ++gene) {
                crossed.push_back(
                    (descendant.from_second.contains(gene) ? descendant.second_genes : descendant.first_genes)[gene]);
            }
            std::vector<float> made = crossed;
            reordered += descendant.order.has_value();
            for (unsigned gene = 0; gene < bred.size() && descendant.order; ++gene) {
                made[gene] = crossed[(*descendant.order)[gene]];
            }
            for (const GeneChange& change : descendant.changes) {
                ASSERT_EQ(made[change.gene], change.before);
                made[change.gene] = change.after;
            }
            ASSERT_EQ(made, descendant.genes);
        }
        EXPECT_GT(reordered, 10u);
    }
}

} // namespace
} // namespace evod::evolution
