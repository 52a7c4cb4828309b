#include "server/evolution/price.h"

#include "server/evolution/migration.h"
#include "server/evolution/next_generation.h"
#include "server/jobs/thread_pool.h"
#include "tests/unit/evolution/draws.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace evod::evolution {
namespace {

/// The input and the result of a breeding.
struct Bred {
    GeneMatrix before, bred_from;
    NextGeneration next;
    bool migrants_came = false;
    SelectionAccount account{};
};

struct Case {
    Parameters parameters;
    std::uint32_t present = 40, wanted = 40;
    bool migration = false;
    std::uint64_t seed = 1;
};

/// Fitness is drawn, independent of the genes, unless `by_first_gene` is set: then it is the first gene.
Bred breed(const Case& of, bool by_first_gene = false) {
    base::InlineExecutor executor;
    Bred bred;
    std::vector<GeneMatrix> islands;
    std::vector<std::vector<double>> fitness(2);
    for (std::uint32_t island = 0; island < 2; ++island) {
        Parameters first = of.parameters;
        first.initial_gene_min += 30 * island; // different from those born there
        first.initial_gene_max += 30 * island;
        islands.push_back(initial_population(of.present, first, base::Seed{of.seed}, island));
        base::RandomStream random = stream_of(of.seed, island);
        for (std::uint32_t i = 0; i < of.present; ++i) {
            fitness[island].push_back(by_first_gene ? static_cast<double>(islands.back()(0, i))
                                                    : random.uniform(0, 300));
        }
    }
    bred.before = islands[0];
    if (of.migration) {
        Parameters parameters = of.parameters;
        parameters.migration = Topology::Ring;
        parameters.migrant_count = 3;
        const std::vector<std::span<const double>> known(fitness.begin(), fitness.end());
        const auto migrants = choose_migrants(known, parameters, base::Seed{of.seed}, 1);
        const std::vector<IslandPopulation> populations{{&islands[0], fitness[0]}, {&islands[1], fitness[1]}};
        migrate(migrants, populations);
        bred.migrants_came = true;
    }
    bred.bred_from = islands[0];
    bred.next = next_generation(fitness[0], bred.bred_from, of.parameters, of.wanted,
                                {.seed = base::Seed{of.seed}, .island = 0, .generation = 1}, executor);
    bred.account = account_for(bred.before, bred.migrants_came ? bred.bred_from : bred.before, bred.next.genes,
                               bred.next.parents, executor);
    return bred;
}

double largest(const GeneAccount& gene) {
    return std::max(
        {std::abs(gene.selection), std::abs(gene.transmission), std::abs(gene.migration), std::abs(gene.change)});
}

double mean(const GeneMatrix& genes, unsigned gene) {
    return genes.row(gene).cast<double>().mean();
}

/// The Price equation as written, organism by organism, in long double.
SelectionAccount by_definition(const Bred& bred) {
    using Real = long double;
    const auto n = static_cast<std::size_t>(bred.before.cols());
    const auto genes = static_cast<unsigned>(bred.before.rows());
    SelectionAccount account(genes);
    for (unsigned gene = 0; gene < genes; ++gene) {
        const auto z = [&](std::uint32_t i) { return static_cast<Real>(bred.bred_from(gene, i)); };
        std::vector<Real> shares(n), moved(n); // of each organism; moved: Σ share · (descendant − organism)
        for (std::size_t child = 0; child < bred.next.parents.size(); ++child) {
            for (const std::uint32_t parent : {bred.next.parents[child].first, bred.next.parents[child].second}) {
                shares[parent] += 0.5L;
                moved[parent] +=
                    0.5L * (static_cast<Real>(bred.next.genes(gene, static_cast<long>(child))) - z(parent));
            }
        }
        Real w_mean = 0, z_mean = 0, z_born = 0, z_next = 0;
        for (std::uint32_t i = 0; i < n; ++i) {
            w_mean += shares[i] / static_cast<Real>(n);
            z_mean += z(i) / static_cast<Real>(n);
            z_born += static_cast<Real>(bred.before(gene, i)) / static_cast<Real>(n);
        }
        for (std::size_t child = 0; child < bred.next.parents.size(); ++child) {
            z_next += static_cast<Real>(bred.next.genes(gene, static_cast<long>(child))) /
                      static_cast<Real>(bred.next.parents.size());
        }
        Real covariance = 0, transmission = 0;
        for (std::uint32_t i = 0; i < n; ++i) {
            covariance += (shares[i] - w_mean) * (z(i) - z_mean) / static_cast<Real>(n);
            transmission += moved[i] / static_cast<Real>(n); // w Δz
        }
        account[gene] = {.selection = static_cast<double>(covariance / w_mean),
                         .transmission = static_cast<double>(transmission / w_mean),
                         .migration = static_cast<double>(z_mean - z_born),
                         .change = static_cast<double>(z_next - z_born)};
    }
    return account;
}

void expect_closed(const SelectionAccount& account) {
    for (std::size_t gene = 0; gene < account.size(); ++gene) {
        const GeneAccount& of = account[gene];
        EXPECT_NEAR(of.selection + of.transmission + of.migration, of.change, 1e-9 * largest(of)) << gene;
    }
}

/// The account closes, and equals the Price equation as written.
void expect_as_defined(const Bred& bred) {
    expect_closed(bred.account);
    const SelectionAccount defined = by_definition(bred);
    ASSERT_EQ(bred.account.size(), defined.size());
    for (unsigned gene = 0; gene < defined.size(); ++gene) {
        const GeneAccount &one = bred.account[gene], &other = defined[gene];
        const double allowed = 1e-9 * std::max(largest(other), 1e-3);
        EXPECT_NEAR(one.selection, other.selection, allowed);
        EXPECT_NEAR(one.transmission, other.transmission, allowed);
        EXPECT_NEAR(one.migration, other.migration, allowed);
        EXPECT_NEAR(one.change, other.change, allowed);
        EXPECT_NEAR(one.change, mean(bred.next.genes, gene) - mean(bred.before, gene), 1e-10);
    }
}

TEST(Price, EqualsAnExampleComputedByHand) {
    // Four organisms with mean 130. A migrant of 200 replaces the first: mean 155. Of five descendants, the first is
    // the migrant itself, the second is organism 1 after a mutation by +6, and the others are children.
    base::InlineExecutor executor;
    const auto population = [](std::initializer_list<float> values) {
        GeneMatrix genes(body_gene_count, static_cast<Eigen::Index>(values.size()));
        for (Eigen::Index i = 0; const float value : values) {
            genes.col(i++) = value;
        }
        return genes;
    };
    const GeneMatrix before = population({100, 120, 140, 160}), bred_from = population({200, 120, 140, 160});
    const std::vector<Parents> parents{{0, 0}, {1, 1}, {0, 3}, {0, 3}, {2, 3}};
    const GeneMatrix born = population({200, 126, 190, 170, 140});
    // Shares: 1 + ½ + ½ = 2, 1, ½, ½ + ½ + ½ = 1½, of five. The parents' mean by shares:
    // (2 · 200 + 1 · 120 + ½ · 140 + 1½ · 160) / 5 = 166; the descendants' mean: 165.2.
    for (const GeneAccount& gene : account_for(before, bred_from, born, parents, executor)) {
        EXPECT_DOUBLE_EQ(gene.migration, 25);        // 155 − 130
        EXPECT_DOUBLE_EQ(gene.selection, 11);        // 166 − 155
        EXPECT_NEAR(gene.transmission, -0.8, 1e-14); // 165.2 − 166
        EXPECT_DOUBLE_EQ(gene.change, 35.2);         // 165.2 − 130
    }
}

TEST(Price, EqualsTheWrittenEquationForEveryChoice) {
    std::uint64_t seed = 0;
    for (const auto model : {PopulationModel::Hybrid, PopulationModel::Generational, PopulationModel::SteadyState}) {
        for (const auto selection :
             {SelectionMethod::Roulette, SelectionMethod::StochasticUniversal, SelectionMethod::Tournament,
              SelectionMethod::Random, SelectionMethod::Truncation}) {
            for (const auto crossover : {CrossoverMethod::Uniform, CrossoverMethod::SinglePoint,
                                         CrossoverMethod::MultiPoint, CrossoverMethod::Blend, CrossoverMethod::None}) {
                for (const bool mutation : {false, true}) {
                    for (const bool mutate_survivors : {false, true}) {
                        for (const bool migration : {false, true}) {
                            for (const std::uint32_t wanted : {25u, 40u, 71u}) {
                                Case of{.parameters = {}, .wanted = wanted, .migration = migration, .seed = ++seed};
                                of.parameters.population_model = model;
                                of.parameters.selection = selection;
                                of.parameters.crossover = crossover;
                                of.parameters.mutation_chance = mutation ? 0.3 : 0;
                                of.parameters.mutate_survivors = mutate_survivors;
                                of.parameters.elite_count = static_cast<std::uint32_t>(seed % 3);
                                of.parameters.replaced_count = 11;
                                if (seed % 5 == 0) { // bounds that are narrower than before
                                    of.parameters.impulse_max = 95;
                                }
                                if (seed % 7 == 0) {
                                    of.parameters.rearranging = OrderMutationMethod::Scramble;
                                }
                                const Bred bred = breed(of);
                                SCOPED_TRACE(seed);
                                expect_as_defined(bred);
                                if (testing::Test::HasFailure()) {
                                    return;
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

TEST(Price, EqualsTheWrittenEquationBeyondSixGenes) {
    std::uint64_t seed = 5000;
    for (const unsigned genes : wide_gene_counts) {
        for (const auto crossover : {CrossoverMethod::Uniform, CrossoverMethod::SinglePoint,
                                     CrossoverMethod::MultiPoint, CrossoverMethod::Blend, CrossoverMethod::None}) {
            for (const auto group :
                 {GeneGroup::All, GeneGroup::Body, genes == 328 ? GeneGroup::Brain : GeneGroup::Free}) {
                for (const bool migration : {false, true}) {
                    Case of{.parameters = wide_parameters(genes), .wanted = 71, .migration = migration, .seed = ++seed};
                    of.parameters.crossover = crossover;
                    of.parameters.mutate_group = group;
                    of.parameters.mutation_chance = 0.3;
                    of.parameters.reset_chance = 0.02;
                    of.parameters.scale_chance = 0.5;
                    of.parameters.bit_flip_chance = 0.01;
                    of.parameters.rearranging = OrderMutationMethod::Scramble;
                    of.parameters.mutate_survivors = true;
                    SCOPED_TRACE(seed);
                    const Bred bred = breed(of);
                    expect_as_defined(bred);
                    ASSERT_EQ(bred.account.size(), genes);
                    ASSERT_FALSE(testing::Test::HasFailure());
                }
            }
        }
    }
}

RC_GTEST_PROP(Price, AddsUpForAnyGenes, ()) {
    const auto count = [](std::uint32_t end) { return *rc::gen::inRange(1u, end); };
    const std::uint32_t present = count(60), wanted = count(90);
    const auto genes_of = [&](std::uint32_t organisms) {
        GeneMatrix genes(body_gene_count, static_cast<Eigen::Index>(organisms));
        for (Eigen::Index i = 0; i < genes.size(); ++i) { // everywhere within the possible bounds, including the lowest
            genes.data()[i] = std::ldexp(static_cast<float>(*rc::gen::inRange(0, 10'001)), -*rc::gen::inRange(0, 30));
        }
        return genes;
    };
    const GeneMatrix before = genes_of(present), bred_from = genes_of(present), born = genes_of(wanted);
    std::vector<Parents> parents;
    for (std::uint32_t i = 0; i < wanted; ++i) {
        parents.push_back({*rc::gen::inRange(0u, present), *rc::gen::inRange(0u, present)});
    }
    base::InlineExecutor executor;
    for (const GeneAccount& gene : account_for(before, bred_from, born, parents, executor)) {
        RC_ASSERT(std::abs(gene.selection + gene.transmission + gene.migration - gene.change) <= 1e-9 * largest(gene));
    }
}

TEST(Price, SiblingsWithoutMutationDoNotChangeTheMean) {
    // Siblings are complements wherever the cuts are, so the whole change is selection, to the last bit.
    for (const auto crossover :
         {CrossoverMethod::Uniform, CrossoverMethod::SinglePoint, CrossoverMethod::MultiPoint, CrossoverMethod::None}) {
        Case of{.parameters = {}, .wanted = 48}; // 24 survivors, 12 pairs
        of.parameters.crossover = crossover;
        of.parameters.mutation_chance = 0;
        for (const GeneAccount& gene : breed(of).account) {
            EXPECT_EQ(gene.transmission, 0);
            EXPECT_EQ(gene.migration, 0);
            EXPECT_EQ(gene.change, gene.selection);
            EXPECT_NE(gene.selection, 0);
        }
    }
    // Blended siblings have the sum of their parents' genes except for rounding: at most 2^-23 of a gene per pair.
    Case of{.parameters = {}, .wanted = 48};
    of.parameters.crossover = CrossoverMethod::Blend;
    of.parameters.mutation_chance = 0;
    for (const GeneAccount& gene : breed(of).account) {
        EXPECT_LE(std::abs(gene.transmission), 0x1p-23 * 250 * 12 / 48);
        EXPECT_GT(std::abs(gene.selection), 0.001);
    }
}

TEST(Price, TruncationSelectsTheMeanOfTheBest) {
    // Each organism of the better half survives once and is in one pair with two children: its share is 2. The mean of
    // the gene that selection uses becomes the mean of the better half.
    Case of;
    of.parameters.selection = SelectionMethod::Truncation;
    of.parameters.mutation_chance = 0;
    const Bred bred = breed(of, true);
    std::vector<float> sorted(40);
    for (Eigen::Index i = 0; i < 40; ++i) {
        sorted[static_cast<std::size_t>(i)] = bred.before(0, i);
    }
    std::ranges::sort(sorted, std::greater{});
    const double best = std::accumulate(sorted.begin(), sorted.begin() + 20, 0.0) / 20;
    EXPECT_NEAR(bred.account[0].selection, best - mean(bred.before, 0), 1e-11);
    EXPECT_GT(bred.account[0].selection, 5) << "half the spread of genes that are uniform in [80, 120], or near it";
    EXPECT_EQ(bred.account[0].transmission, 0);
}

TEST(Price, IfAllSurviveTheChangeIsTransmissionAlone) {
    Case of;
    of.parameters.selection = SelectionMethod::Truncation;
    of.parameters.survivors = 1;
    of.parameters.mutate_survivors = true;
    of.parameters.mutation_chance = 0.5;
    for (const GeneAccount& gene : breed(of).account) {
        EXPECT_EQ(gene.selection, 0);
        EXPECT_NE(gene.transmission, 0);
        EXPECT_NEAR(gene.change, gene.transmission, 1e-12);
    }
    of.parameters.mutation_chance = 0;
    for (const GeneAccount& gene : breed(of).account) {
        EXPECT_EQ(gene, GeneAccount{});
    }
}

TEST(Price, MigrantsAloneChangeAnIdleIsland) {
    Case of{.parameters = {}, .migration = true};
    of.parameters.selection = SelectionMethod::Truncation;
    of.parameters.survivors = 1;
    const Bred bred = breed(of);
    for (unsigned gene = 0; gene < body_gene_count; ++gene) {
        EXPECT_EQ(bred.account[gene].selection, 0);
        EXPECT_EQ(bred.account[gene].transmission, 0);
        EXPECT_NEAR(bred.account[gene].migration, mean(bred.bred_from, gene) - mean(bred.before, gene), 1e-12);
        EXPECT_GT(bred.account[gene].migration, 0.5) << "three of forty that are 30 greater, or near it";
        EXPECT_NEAR(bred.account[gene].change, bred.account[gene].migration, 1e-12);
    }
}

TEST(Price, RandomSelectionHasZeroSelectionOnAverage) {
    // The mean of many terms, divided by its standard error, is normal: by chance alone |t| is above 5.5 with a
    // probability of 4e-8 for each gene, less than `alpha` for all of them.
    constexpr std::uint32_t seeds = 400;
    std::array<double, body_gene_count> sums{}, squares{};
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        Case of{.parameters = {}, .seed = seed};
        of.parameters.selection = SelectionMethod::Random;
        const SelectionAccount account = breed(of).account;
        for (unsigned gene = 0; gene < body_gene_count; ++gene) {
            sums[gene] += account[gene].selection;
            squares[gene] += account[gene].selection * account[gene].selection;
        }
    }
    for (unsigned gene = 0; gene < body_gene_count; ++gene) {
        const double mean = sums[gene] / seeds, variance = squares[gene] / seeds - mean * mean;
        EXPECT_GT(variance, 0.01);
        EXPECT_LT(std::abs(mean) / std::sqrt(variance / seeds), 5.5) << body_gene_names[gene];
    }
}

TEST(Price, IsTheSameOnAnyNumberOfThreads) {
    Case of{.parameters = {}, .present = 30'011, .wanted = 41'003, .migration = true};
    const Bred bred = breed(of);
    expect_closed(bred.account);
    for (const std::size_t threads : {2u, 3u, 8u}) {
        jobs::ThreadPool executor{threads};
        EXPECT_EQ(account_for(bred.before, bred.bred_from, bred.next.genes, bred.next.parents, executor), bred.account)
            << threads;
    }
}

TEST(Price, NumbersAreWrittenAndReadInOneOrder) {
    const SelectionAccount account = breed({.parameters = {}, .migration = true}).account;
    std::vector<std::string> names;
    std::vector<std::optional<double>> numbers;
    for_each_number(account, body_gene_names, [&](const std::string& name, std::optional<double> number) {
        names.push_back(name);
        numbers.push_back(number);
    });
    ASSERT_EQ(numbers.size(), 24u);
    EXPECT_EQ(names[0], "normal_speed_selection");
    EXPECT_EQ(names[23], "poison_radius_change");
    const auto read = [&] {
        auto next = numbers.begin();
        return account_from(body_gene_count, [&] { return *next++; });
    };
    EXPECT_EQ(read(), account);
    numbers[5].reset();
    EXPECT_EQ(read(), std::nullopt);
    for_each_number(std::nullopt, body_gene_names,
                    [](const std::string&, std::optional<double> number) { EXPECT_FALSE(number); });
}

} // namespace
} // namespace evod::evolution
