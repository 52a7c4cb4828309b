#include "server/evolution/mutation.h"

#include "tests/unit/evolution/draws.h"

#include <boost/math/distributions/normal.hpp>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <bit>
#include <cmath>

namespace evod::evolution {
namespace {

using Values = std::array<float, body_gene_count>;

/// No mutation at all, and distant bounds.
Parameters still() {
    Parameters parameters;
    parameters.mutation_chance = 0;
    parameters.normal_speed_min = parameters.impulse_min = parameters.base_health_min = 0;
    parameters.food_radius_min = parameters.poison_radius_min = 0;
    parameters.body_size_min = 1;
    parameters.normal_speed_max = parameters.impulse_max = parameters.base_health_max = 10'000;
    parameters.food_radius_max = parameters.poison_radius_max = 10'000;
    parameters.body_size_max = 1000;
    return parameters;
}

constexpr Values middle = {512, 512, 512, 512, 512, 512};

/// Calls `visit` with each of `count` mutants of `start`.
template <class Visit>
void mutants(const Parameters& parameters, const Values& start, std::uint32_t count, std::uint64_t seed,
             const Visit& visit) {
    const ValueMutation<body_gene_count> mutation{parameters};
    for (std::uint32_t i = 0; i < count; ++i) {
        Values genes = start;
        base::RandomStream random = stream_of(seed, i);
        visit(genes, mutation.apply(genes, random));
    }
}

TEST(Creep, StepsAreUniformWithinTheStepSize) {
    // Law: uniform in (−15, 15), of variance 15²/3. Chi-square over 60 cells for each gene, 59 degrees of freedom; the
    // variance of 600,000 steps within 5 standard errors (two-sided 6e-7), the fourth moment of the law being 15⁴/5.
    Parameters parameters = still();
    parameters.mutation_chance = 1;
    parameters.mutation_step = 15;
    std::array<std::vector<std::uint64_t>, body_gene_count> cells;
    cells.fill(std::vector<std::uint64_t>(60));
    double sum = 0, squares = 0;
    mutants(parameters, middle, 100'000, 201, [&](const Values& genes, unsigned) {
        for (unsigned gene = 0; gene < body_gene_count; ++gene) {
            const double step = double{genes[gene]} - 512;
            ASSERT_LE(std::abs(step), 15);
            ++cells[gene].at(std::min<std::size_t>(59, static_cast<std::size_t>((step + 15) * 2)));
            sum += step;
            squares += step * step;
        }
    });
    for (const auto& counts : cells) {
        EXPECT_GT(support::p_value_of_equal_cells(counts), alpha);
    }
    const double count = 600'000, variance = 75;
    EXPECT_NEAR(sum / count, 0, 5 * std::sqrt(variance / count));
    EXPECT_NEAR(squares / count, variance, 5 * std::sqrt((15.0 * 15 * 15 * 15 / 5 - variance * variance) / count));
}

TEST(Creep, GaussianStepsHaveTheStepAsStandardDeviation) {
    // Law: normal, standard deviation 15. Moments of 600,000 steps within 5 standard errors; chi-square over 20 equally
    // likely cells, 19 degrees of freedom.
    Parameters parameters = still();
    parameters.mutation_chance = 1;
    parameters.creep = Creep::Gaussian;
    const boost::math::normal normal;
    std::vector<std::uint64_t> cells(20);
    double sum = 0, squares = 0, fourths = 0;
    mutants(parameters, middle, 100'000, 202, [&](const Values& genes, unsigned) {
        for (const float gene : genes) {
            const double z = (double{gene} - 512) / 15;
            ++cells.at(std::min<std::size_t>(19, static_cast<std::size_t>(20 * boost::math::cdf(normal, z))));
            sum += z;
            squares += z * z;
            fourths += z * z * z * z;
        }
    });
    const double count = 600'000;
    EXPECT_NEAR(sum / count, 0, 5 * std::sqrt(1 / count));
    EXPECT_NEAR(squares / count, 1, 5 * std::sqrt(2 / count));
    EXPECT_NEAR(fourths / count, 3, 5 * std::sqrt(96 / count));
    EXPECT_GT(support::p_value_of_equal_cells(cells), alpha);
}

TEST(Creep, GaussianTailsFollowTheNormalLaw) {
    // Law: normal, standard deviation 1. Chi-square over the steps beyond 3, 3.3, 3.44 (where the ziggurat's lowest
    // layer ends), 3.6, 4 and 4.5, and between, both signs apart: 13 degrees of freedom.
    Parameters parameters = still();
    parameters.creep = Creep::Gaussian;
    parameters.mutation_chance = 1;
    parameters.mutation_step = 100;
    const double ends[] = {-4.5, -4, -3.6, -3.442619855899, -3.3, -3, 0, 3, 3.3, 3.442619855899, 3.6, 4, 4.5};
    std::vector<std::uint64_t> counts(std::size(ends) + 1);
    mutants(parameters, middle, 1'000'000, 217, [&](const Values& genes, unsigned) {
        for (const float gene : genes) {
            ++counts[static_cast<std::size_t>(std::upper_bound(std::begin(ends), std::end(ends), (gene - 512) / 100) -
                                              std::begin(ends))];
        }
    });
    const boost::math::normal normal;
    std::vector<double> law;
    double below = 0;
    for (const double end : ends) {
        law.push_back(boost::math::cdf(normal, end) - below);
        below += law.back();
    }
    law.push_back(1 - below);
    EXPECT_GT(p_value_of_law(counts, law), alpha);
}

TEST(Creep, GaussianStepsOfDifferentGenesAreIndependent) {
    // Law: in each of the 6 genes, each of the 4 quarters of the normal law is equally likely: 4^6 cells. Chi-square,
    // 4095 degrees of freedom.
    Parameters parameters = still();
    parameters.mutation_chance = 1;
    parameters.creep = Creep::Gaussian;
    std::vector<std::uint64_t> cells(4096);
    mutants(parameters, middle, 400'000, 209, [&](const Values& genes, unsigned) {
        std::size_t cell = 0;
        for (const float gene : genes) {
            const double z = (double{gene} - 512) / 15;
            cell = cell * 4 + (z < -0.6744897501960817 ? 0 : z < 0 ? 1 : z < 0.6744897501960817 ? 2 : 3);
        }
        ++cells[cell];
    });
    EXPECT_GT(support::p_value_of_equal_cells(cells), alpha);
}

TEST(Creep, EachGeneMutatesWithItsChanceIndependently) {
    // Law: each of the 64 sets of mutated genes with probability 0.15^k 0.85^(6−k). Chi-square, 63 degrees of freedom.
    Parameters parameters = still();
    parameters.mutation_chance = 0.15;
    std::vector<std::uint64_t> counts(64);
    mutants(parameters, middle, 3'000'000, 203, [&](const Values& genes, unsigned) {
        unsigned mutated = 0;
        for (unsigned gene = 0; gene < body_gene_count; ++gene) {
            mutated |= unsigned{genes[gene] != 512} << gene;
        }
        ++counts[mutated];
    });
    // A step of the uniform law rounds to the same float with probability below 1e-5, which is too rare to be seen
    // here.
    std::vector<double> law(64);
    for (unsigned set = 0; set < 64; ++set) {
        law[set] = std::pow(0.15, std::popcount(set)) * std::pow(0.85, 6 - std::popcount(set));
    }
    EXPECT_GT(p_value_of_law(counts, law), alpha);
}

TEST(Reset, IsUniformWithinTheBoundsOfEachGene) {
    // Law: with probability 0.5 uniform in the gene's bounds. Chi-square over 1 + 40 cells, 40 degrees of freedom.
    Parameters parameters; // the bounds of the default world
    parameters.mutation_chance = 0;
    parameters.reset_chance = 0.5;
    const GeneBounds bounds = gene_bounds(parameters);
    std::array<std::vector<std::uint64_t>, body_gene_count> cells;
    cells.fill(std::vector<std::uint64_t>(41));
    constexpr float start = 100.0001f; // a draw hits it with probability 1e-7
    mutants(parameters, {start, start, start, start, start, start}, 200'000, 204, [&](const Values& genes, unsigned) {
        for (unsigned gene = 0; gene < body_gene_count; ++gene) {
            ASSERT_GE(genes[gene], bounds.min[gene]);
            ASSERT_LE(genes[gene], bounds.max[gene]);
            const float share = (genes[gene] - bounds.min[gene]) / (bounds.max[gene] - bounds.min[gene]);
            ++cells[gene]
                   [genes[gene] == start ? 0 : 1 + std::min<std::size_t>(39, static_cast<std::size_t>(share * 40))];
        }
    });
    std::vector<double> law(41, 0.5 / 40);
    law[0] = 0.5;
    for (const auto& counts : cells) {
        EXPECT_GT(p_value_of_law(counts, law), alpha);
    }
}

TEST(Scale, MultipliesOneGeneByAUniformFactor) {
    // Law: with probability 0.6 one of the 6 genes, each equally likely, is multiplied by a factor uniform in (0.75,
    // 1.25). Chi-square over 6 × 50 cells and the chromosomes without a change, 300 degrees of freedom; the factor of 1
    // itself has probability 1e-7.
    Parameters parameters = still();
    parameters.scale_chance = 0.6;
    parameters.scale_range = 0.25;
    constexpr Values start = {100, 200, 300, 400, 500, 600};
    std::vector<std::uint64_t> counts(301);
    mutants(parameters, start, 600'000, 210, [&](const Values& genes, unsigned clamped) {
        ASSERT_EQ(clamped, 0u);
        std::size_t cell = 300;
        for (unsigned gene = 0; gene < body_gene_count; ++gene) {
            if (genes[gene] == start[gene]) {
                continue;
            }
            ASSERT_EQ(cell, 300u) << "one gene at most";
            const double factor = double{genes[gene]} / double{start[gene]};
            ASSERT_GE(factor, 0.75 - 1e-6);
            ASSERT_LE(factor, 1.25 + 1e-6);
            cell = gene * 50 + std::min<std::size_t>(49, static_cast<std::size_t>(std::max(factor - 0.75, 0.0) * 100));
        }
        ++counts[cell];
    });
    std::vector<double> law(301, 0.6 / 300);
    law[300] = 0.4;
    EXPECT_GT(p_value_of_law(counts, law), alpha);
}

TEST(Scale, FollowsCreepAndPrecedesTheBounds) {
    Parameters parameters; // the bounds of the default world
    parameters.mutation_chance = 1;
    parameters.scale_chance = 1;
    parameters.scale_range = 1;
    const GeneBounds bounds = gene_bounds(parameters);
    const ValueMutation<> mutation{parameters};
    std::uint32_t clamped = 0;
    for (std::uint32_t i = 0; i < 2000; ++i) {
        Values genes = {100, 100, 100, 100, 100, 100}, same = genes;
        base::RandomStream random = stream_of(211, i), again = random;
        std::vector<GeneChange> changes;
        const unsigned counted = mutation.apply(genes, random, changes);
        ASSERT_EQ(mutation.apply(same, again), counted);
        ASSERT_EQ(same, genes);
        ASSERT_EQ(changes.size(), body_gene_count + 1 + counted);
        const GeneChange& scaled = changes[body_gene_count];
        ASSERT_EQ(scaled.kind, ChangeKind::Scale);
        ASSERT_EQ(scaled.before, changes[scaled.gene].after) << "of the creep mutation";
        ASSERT_GE(genes[scaled.gene], bounds.min[scaled.gene]);
        ASSERT_LE(genes[scaled.gene], bounds.max[scaled.gene]);
        for (std::size_t k = body_gene_count + 1; k < changes.size(); ++k) {
            ASSERT_EQ(changes[k].kind, ChangeKind::Clamp);
            ASSERT_EQ(changes[k].gene, scaled.gene) << "creep alone cannot leave the bounds";
        }
        clamped += counted;
    }
    EXPECT_GT(clamped, 200u);
    EXPECT_LT(clamped, 800u); // factors below 0.2 to 0.4, and some above 2
}

TEST(BitFlip, EveryBitFlipsWithItsChanceIndependently) {
    // Law: p^k (1−p)^(3−k) for each of the 8 sets of flipped bits of a 3-bit gene, p = 0.2. Chi-square, 7 degrees of
    // freedom for each gene.
    Parameters parameters;
    parameters.mutation_chance = 0;
    parameters.bit_flip_chance = 0.2;
    parameters.bit_flip_bits = 3;
    const GeneBounds bounds = gene_bounds(parameters);
    Values start;
    for (unsigned gene = 0; gene < body_gene_count; ++gene) {
        start[gene] = BinaryView{bounds.min[gene], bounds.max[gene], 3}.to_value(5);
    }
    std::array<std::vector<std::uint64_t>, body_gene_count> flips;
    flips.fill(std::vector<std::uint64_t>(8));
    mutants(parameters, start, 200'000, 205, [&](const Values& genes, unsigned clamped) {
        ASSERT_EQ(clamped, 0u);
        for (unsigned gene = 0; gene < body_gene_count; ++gene) {
            ++flips[gene].at(BinaryView{bounds.min[gene], bounds.max[gene], 3}.to_code(genes[gene]) ^ 5u);
        }
    });
    std::vector<double> law(8);
    for (unsigned set = 0; set < 8; ++set) {
        law[set] = std::pow(0.2, std::popcount(set)) * std::pow(0.8, 3 - std::popcount(set));
    }
    for (const auto& counts : flips) {
        EXPECT_GT(p_value_of_law(counts, law), alpha);
    }
}

TEST(BitFlip, LeavesGenesWithoutFlippedBitsUnchanged) {
    Parameters parameters;
    parameters.mutation_chance = 0;
    parameters.bit_flip_chance = 0.05;
    parameters.bit_flip_bits = 4; // coarse, so that rounding to the nearest code is visible
    constexpr Values start = {101.3f, 99.7f, 88.1f, 111.9f, 104.2f, 93.4f};
    std::uint64_t untouched = 0;
    mutants(parameters, start, 1000, 206, [&](const Values& genes, unsigned) {
        for (unsigned gene = 0; gene < body_gene_count; ++gene) {
            untouched += genes[gene] == start[gene];
        }
    });
    EXPECT_GT(untouched, 4500u); // 0.95⁴ of 6,000 is 4,887
    EXPECT_LT(untouched, 5300u);
}

TEST(BinaryView, CodesSpanTheBounds) {
    for (const unsigned bits : {1u, 2u, 16u, 24u}) {
        const BinaryView view{20, 250, bits};
        const std::uint32_t last = (1u << bits) - 1;
        EXPECT_EQ(view.to_value(0), 20);
        EXPECT_EQ(view.to_value(last), 250);
        EXPECT_EQ(view.to_code(20), 0u);
        EXPECT_EQ(view.to_code(250), last);
    }
    EXPECT_EQ((BinaryView{0, 15, 4}.to_code(7.4f)), 7u);
    EXPECT_EQ((BinaryView{0, 15, 4}.to_value(8)), 8);
    EXPECT_EQ((BinaryView{5, 5, 8}.to_code(5)), 0u);
    EXPECT_EQ((BinaryView{5, 5, 8}.to_value(200)), 5);
}

RC_GTEST_PROP(BinaryView, EveryCodeConvertsToAValueAndBack, ()) {
    const unsigned bits = *rc::gen::inRange(1u, 17u);
    const BinaryView view{20, 250, bits};
    const std::uint32_t code = *rc::gen::inRange(0u, 1u << bits);
    RC_ASSERT(view.to_code(view.to_value(code)) == code);
}

TEST(Bounds, EveryGeneOutsideIsClampedAndCounted) {
    Parameters parameters; // body_size 40 … 200
    parameters.mutation_chance = 1;
    parameters.mutation_step = 1000;
    const GeneBounds bounds = gene_bounds(parameters);
    std::uint64_t at_a_bound = 0, counted = 0;
    mutants(parameters, {100, 100, 100, 100, 100, 100}, 10'000, 207, [&](const Values& genes, unsigned clamped) {
        counted += clamped;
        for (unsigned gene = 0; gene < body_gene_count; ++gene) {
            ASSERT_GE(genes[gene], bounds.min[gene]);
            ASSERT_LE(genes[gene], bounds.max[gene]);
            at_a_bound += genes[gene] == bounds.min[gene] || genes[gene] == bounds.max[gene];
        }
    });
    EXPECT_EQ(counted, at_a_bound);
    EXPECT_GT(counted, 50'000u); // nine in ten steps leave the bounds
}

/// Chromosomes with 20 free genes, which alone mutate, bounded by 0 and 1024. No mutation at all.
Parameters twenty_free_genes() {
    Parameters parameters;
    parameters.mutation_chance = 0;
    parameters.free_genes = 20;
    parameters.free_gene_max = 1024;
    parameters.mutate_group = GeneGroup::Free;
    return parameters;
}

/// Calls `visit` with the free genes of each of 10,000 mutants of chromosomes whose free genes are start(random).
template <class Start, class Visit>
void free_mutants(const Parameters& parameters, const Start& start, std::uint64_t seed, const Visit& visit) {
    const ValueMutation<> mutation{parameters};
    for (std::uint32_t i = 0; i < 10'000; ++i) {
        base::RandomStream random = stream_of(seed, i);
        std::vector<float> genes(gene_count(parameters), 100);
        const Genes free = Genes{genes}.subspan(body_gene_count);
        std::ranges::generate(free, [&] { return start(random); });
        const unsigned outside = mutation.apply(Genes{genes}, random);
        visit(free, outside);
    }
}

TEST(Creep, PolynomialStepsFollowTheirLaw) {
    // Law: with d = step / (max − min), the cumulative probability of d < 0 is (1 + d)^(n + 1) / 2, cut off at the
    // lower bound by the share that lies beyond, and likewise for d > 0. Chi-square over 20 equally likely cells, 19
    // degrees of freedom, for genes in the middle of their bounds and at a tenth of them.
    for (const double at : {0.5, 0.1}) {
        Parameters parameters = twenty_free_genes();
        parameters.mutation_chance = 1;
        parameters.creep = Creep::Polynomial;
        parameters.mutation_spread_index = 3;
        const auto start = static_cast<float>(1024 * at);
        const double beyond = std::pow(1 - at, 4), beyond_above = std::pow(at, 4); // (1 − room)^(n + 1)
        std::vector<std::uint64_t> cells(20);
        free_mutants(
            parameters, [&](base::RandomStream&) { return start; }, 218,
            [&](std::span<const float> genes, unsigned outside) {
                ASSERT_EQ(outside, 0u);
                for (const float gene : genes) {
                    const double d = double{gene} / 1024 - double{start} / 1024;
                    const double below = d < 0 ? (std::pow(1 + d, 4) - beyond) / (1 - beyond) / 2
                                               : 1 - (std::pow(1 - d, 4) - beyond_above) / (1 - beyond_above) / 2;
                    ++cells.at(std::clamp(static_cast<int>(20 * below), 0, 19));
                }
            });
        EXPECT_GT(support::p_value_of_equal_cells(cells), alpha) << at;
    }
}

TEST(Bounds, ReflectingKeepsTheUniformLaw) {
    // Law: genes that are uniform within their bounds stay so, whatever the symmetric step. Chi-square over 100 cells
    // for each size of step, 99 degrees of freedom.
    for (const double step : {100.0, 900.0}) {
        Parameters parameters = twenty_free_genes();
        parameters.mutation_chance = 1;
        parameters.free_mutation_step = step;
        parameters.out_of_bounds = OutOfBounds::Reflect;
        std::vector<std::uint64_t> cells(100);
        free_mutants(
            parameters, [](base::RandomStream& random) { return static_cast<float>(random.uniform(0, 1024)); }, 219,
            [&](std::span<const float> genes, unsigned) {
                for (const float gene : genes) {
                    ASSERT_TRUE(gene >= 0 && gene <= 1024);
                    ++cells.at(std::min<std::size_t>(99, static_cast<std::size_t>(gene / 10.24f)));
                }
            });
        EXPECT_GT(support::p_value_of_equal_cells(cells), alpha) << step;
    }
}

TEST(Bounds, ReflectingMirrorsAtTheBound) {
    Parameters parameters = twenty_free_genes();
    parameters.out_of_bounds = OutOfBounds::Reflect;
    const ValueMutation<> mutation{parameters};
    std::vector<float> genes(body_gene_count + 20, 100);
    genes[6] = -24;
    genes[7] = 1034;
    genes[8] = 3000;
    std::vector<GeneChange> changes;
    base::RandomStream random = stream_of(220);
    EXPECT_EQ(mutation.apply(Genes{genes}, random, changes), 3u);
    EXPECT_EQ(changes, (std::vector<GeneChange>{{6, ChangeKind::Reflect, -24, 24},
                                                {7, ChangeKind::Reflect, 1034, 1014},
                                                {8, ChangeKind::Reflect, 3000, 952}})); // 3000 − 2 · 1024
    EXPECT_EQ(genes[8], 952);
}

TEST(Bounds, RedrawnGenesAreUniform) {
    // Law: a gene that left its bounds is uniform within them. Chi-square over 100 cells, 99 degrees of freedom.
    Parameters parameters = twenty_free_genes();
    parameters.out_of_bounds = OutOfBounds::Redraw;
    std::vector<std::uint64_t> cells(100);
    free_mutants(
        parameters, [](base::RandomStream&) { return 1025.0f; }, 221,
        [&](std::span<const float> genes, unsigned outside) {
            ASSERT_EQ(outside, 20u);
            for (const float gene : genes) {
                ++cells.at(std::min<std::size_t>(99, static_cast<std::size_t>(gene / 10.24f)));
            }
        });
    EXPECT_GT(support::p_value_of_equal_cells(cells), alpha);
}

TEST(Bounds, NothingIsCountedIfNoGeneIsOutside) {
    mutants({}, {100, 100, 100, 100, 100, 100}, 1000, 208,
            [](const Values&, unsigned clamped) { ASSERT_EQ(clamped, 0u); });
}

// Chromosomes of more than six genes: the same laws hold for each gene, with the bounds and the step of its group.

/// A chromosome with every gene in the middle of its bounds.
std::vector<float> middle_of_bounds(const Parameters& parameters) {
    const GeneBounds bounds = gene_bounds(parameters);
    const Eigen::ArrayXf genes = (bounds.min + bounds.max) / 2;
    return {genes.begin(), genes.end()};
}

template <class Visit>
void wide_mutants(const Parameters& parameters, std::uint32_t count, std::uint64_t seed, const Visit& visit) {
    const std::vector<float> start = middle_of_bounds(parameters);
    const ValueMutation<> mutation{parameters};
    for (std::uint32_t i = 0; i < count; ++i) {
        std::vector<float> genes = start;
        base::RandomStream random = stream_of(seed, i);
        ASSERT_EQ(mutation.apply(genes, random), 0u);
        visit(genes);
    }
}

using Rows = std::vector<std::vector<std::uint64_t>>;
Rows rows_of(std::size_t genes, std::size_t cells) {
    return Rows(genes, std::vector<std::uint64_t>(cells));
}

TEST(WideCreep, StepsAreUniformWithinTheStepOfTheGroup) {
    // Law: uniform in ± the step. Chi-square over 20 cells for each gene, 19 degrees of freedom per gene.
    for (const unsigned genes : wide_gene_counts) {
        Parameters parameters = wide_parameters(genes);
        parameters.mutation_chance = 1;
        const std::vector<float> start = middle_of_bounds(parameters);
        const double beyond_body = genes == 328 ? parameters.brain_mutation_step : parameters.free_mutation_step;
        Rows cells = rows_of(genes, 20);
        wide_mutants(parameters, 20'000, 221, [&](const std::vector<float>& mutant) {
            for (unsigned gene = 0; gene < genes; ++gene) {
                const double step = gene < body_gene_count ? parameters.mutation_step : beyond_body;
                const double share = (double{mutant[gene]} - double{start[gene]}) / step;
                ASSERT_LE(std::abs(share), 1.00001);
                ++cells[gene][std::min<std::size_t>(19, static_cast<std::size_t>(std::max(0.0, (share + 1) * 10)))];
            }
        });
        EXPECT_GT(p_value_of_rows(cells, std::vector<double>(20, 0.05)), alpha) << genes;
    }
}

TEST(WideCreep, EachGeneMutatesWithItsChanceIndependently) {
    // Law: each gene with probability 0.15: chi-square with one degree of freedom per gene. The number of mutated genes
    // is binomial: chi-square over its values.
    for (const unsigned genes : wide_gene_counts) {
        Parameters parameters = wide_parameters(genes);
        parameters.mutation_chance = 0.15;
        const std::vector<float> start = middle_of_bounds(parameters);
        Rows of_gene = rows_of(genes, 2);
        std::vector<std::uint64_t> counts(genes + 1);
        wide_mutants(parameters, 20'000, 222, [&](const std::vector<float>& mutant) {
            unsigned mutated = 0;
            for (unsigned gene = 0; gene < genes; ++gene) {
                const bool changed = mutant[gene] != start[gene];
                ++of_gene[gene][changed];
                mutated += changed;
            }
            ++counts[mutated];
        });
        EXPECT_GT(p_value_of_rows(of_gene, std::vector{0.85, 0.15}), alpha) << genes;
        EXPECT_GT(p_value_of_joined_cells(counts, binomial_law(genes, 0.15)), alpha) << genes;
    }
}

TEST(WideReset, IsUniformWithinTheBoundsOfEachGene) {
    // Law: with probability 0.5 uniform in the gene's bounds. Chi-square over 1 + 20 cells, 20 degrees of freedom per
    // gene.
    std::vector<double> law(21, 0.5 / 20);
    law[20] = 0.5;
    for (const unsigned genes : wide_gene_counts) {
        Parameters parameters = wide_parameters(genes);
        parameters.reset_chance = 0.5;
        parameters.free_gene_min = -3;
        parameters.free_gene_max = 11;
        const GeneBounds bounds = gene_bounds(parameters);
        const std::vector<float> start = middle_of_bounds(parameters);
        Rows cells = rows_of(genes, 21);
        wide_mutants(parameters, 5'000, 223, [&](const std::vector<float>& mutant) {
            for (unsigned gene = 0; gene < genes; ++gene) {
                ASSERT_GE(mutant[gene], bounds.min[gene]);
                ASSERT_LE(mutant[gene], bounds.max[gene]);
                const float share = (mutant[gene] - bounds.min[gene]) / (bounds.max[gene] - bounds.min[gene]);
                ++cells[gene][mutant[gene] == start[gene]
                                  ? 20
                                  : std::min<std::size_t>(19, static_cast<std::size_t>(share * 20))];
            }
        });
        EXPECT_GT(p_value_of_rows(cells, law), alpha) << genes;
    }
}

TEST(WideScale, MultipliesEachGeneEquallyOften) {
    // Law: with probability 0.6 one gene, each equally likely, is multiplied by a factor uniform in (0.75, 1.25).
    // Chi-square over 10 cells per gene and the chromosomes without a change.
    for (const unsigned genes : wide_gene_counts) {
        Parameters parameters = wide_parameters(genes);
        parameters.scale_chance = 0.6;
        parameters.scale_range = 0.25;
        parameters.free_gene_max = 4;
        const ValueMutation<> mutation{parameters};
        std::vector<float> start(genes, 2.0f);
        std::fill(start.begin(), start.begin() + body_gene_count, 100.0f);
        std::vector<std::uint64_t> counts(10 * genes + 1);
        for (std::uint32_t i = 0; i < 100'000; ++i) {
            std::vector<float> mutant = start;
            base::RandomStream random = stream_of(224, i);
            ASSERT_EQ(mutation.apply(mutant, random), 0u);
            std::size_t cell = 10 * genes;
            for (unsigned gene = 0; gene < genes; ++gene) {
                if (mutant[gene] != start[gene]) {
                    ASSERT_EQ(cell, 10 * genes) << "one gene at most";
                    const double factor = double{mutant[gene]} / double{start[gene]};
                    ASSERT_LE(std::abs(factor - 1), 0.25001);
                    cell = gene * 10 +
                           std::min<std::size_t>(9, static_cast<std::size_t>(std::max(factor - 0.75, 0.0) * 20));
                }
            }
            ++counts[cell];
        }
        std::vector<double> law(10 * genes + 1, 0.06 / genes);
        law.back() = 0.4;
        EXPECT_GT(p_value_of_law(counts, law), alpha) << genes;
    }
}

TEST(WideBitFlip, EveryBitFlipsWithItsChanceIndependently) {
    // Law: p^k (1−p)^(3−k) for each of the 8 sets of flipped bits of a 3-bit gene. Chi-square, 7 degrees of freedom per
    // gene. Flips with the chance 0.1 are drawn by their distances, six genes at a time.
    for (const double chance : {0.2, 0.1}) {
        std::vector<double> law(8);
        for (unsigned set = 0; set < 8; ++set) {
            law[set] = std::pow(chance, std::popcount(set)) * std::pow(1 - chance, 3 - std::popcount(set));
        }
        for (const unsigned genes : wide_gene_counts) {
            Parameters parameters = wide_parameters(genes);
            parameters.bit_flip_chance = chance;
            parameters.bit_flip_bits = 3;
            const GeneBounds bounds = gene_bounds(parameters);
            const auto view_of = [&](unsigned gene) { return BinaryView{bounds.min[gene], bounds.max[gene], 3}; };
            const std::vector<float> start = middle_of_bounds(parameters);
            std::vector<std::uint32_t> start_codes;
            for (unsigned gene = 0; gene < genes; ++gene) {
                start_codes.push_back(view_of(gene).to_code(start[gene]));
            }
            Rows flips = rows_of(genes, 8);
            wide_mutants(parameters, 5'000, 225, [&](const std::vector<float>& mutant) {
                for (unsigned gene = 0; gene < genes; ++gene) {
                    ++flips[gene].at(view_of(gene).to_code(mutant[gene]) ^ start_codes[gene]);
                }
            });
            EXPECT_GT(p_value_of_rows(flips, law), alpha) << genes << " genes, chance " << chance;
        }
    }
}

/// A world with 6 genes of the body, a brain of 37 weights and 20 free genes.
Parameters three_groups() {
    Parameters parameters = still();
    parameters.controller = Controller::Network;
    parameters.free_genes = 20;
    return parameters;
}

TEST(MutateGroup, LimitsEachOperatorToItsGenes) {
    // Law: the stated chance that a gene of the group changes. Chi-square, one degree of freedom per gene.
    struct Operator {
        const char* name;
        void (*enable)(Parameters&);
        double chance_per_gene;
    };
    const Operator operators[] = {
        {"creep", [](Parameters& p) { p.mutation_chance = 0.3; }, 0.3},
        {"reset", [](Parameters& p) { p.reset_chance = 0.2; }, 0.2},
        {"rare flips", [](Parameters& p) { p.bit_flip_chance = 0.02; }, 1 - std::pow(0.98, 16)},
        {"flips", [](Parameters& p) { p.bit_flip_chance = 0.2; }, 1 - std::pow(0.8, 16)},
    };
    for (const GeneGroup group : {GeneGroup::All, GeneGroup::Body, GeneGroup::Brain, GeneGroup::Free}) {
        for (const Operator& by : operators) {
            Parameters parameters = three_groups();
            parameters.mutate_group = group;
            by.enable(parameters);
            const GeneRange range = genes_of(group, parameters);
            const std::vector<float> start = middle_of_bounds(parameters);
            Rows changes = rows_of(start.size(), 2);
            wide_mutants(parameters, 20'000, 226, [&](const std::vector<float>& mutant) {
                for (unsigned gene = 0; gene < start.size(); ++gene) {
                    ++changes[gene][mutant[gene] != start[gene]];
                }
            });
            for (unsigned gene = 0; gene < start.size(); ++gene) {
                if (gene - range.first >= range.count) {
                    EXPECT_EQ(changes[gene][1], 0u) << by.name << " of gene " << gene;
                }
            }
            const double chance = by.chance_per_gene;
            EXPECT_GT(
                p_value_of_rows(std::span{changes}.subspan(range.first, range.count), std::vector{1 - chance, chance}),
                alpha)
                << by.name << " of group " << static_cast<int>(group);
        }
    }
}

TEST(MutateGroup, LimitsScalingToItsGenes) {
    // Law: each gene of the group equally often. Chi-square over the genes of the group.
    for (const GeneGroup group : {GeneGroup::All, GeneGroup::Body, GeneGroup::Brain, GeneGroup::Free}) {
        Parameters parameters = three_groups();
        parameters.mutate_group = group;
        parameters.scale_chance = 1;
        parameters.free_gene_max = 4;
        const GeneRange range = genes_of(group, parameters);
        const ValueMutation<> mutation{parameters};
        const std::vector<float> start(gene_count(parameters), 2.0f); // body_size, from 1
        std::vector<std::uint64_t> scaled(start.size());
        for (std::uint32_t i = 0; i < 50'000; ++i) {
            std::vector<float> mutant = start;
            base::RandomStream random = stream_of(227, i);
            ASSERT_EQ(mutation.apply(mutant, random), 0u);
            for (unsigned gene = 0; gene < start.size(); ++gene) {
                scaled[gene] += mutant[gene] != start[gene];
            }
        }
        std::vector<double> law(start.size());
        std::fill_n(law.begin() + range.first, range.count, 1.0 / range.count);
        EXPECT_GT(p_value_of_law(scaled, law), alpha) << static_cast<int>(group);
    }
}

TEST(MutateGroup, GenesOfOtherGroupsStayWithinBounds) {
    Parameters parameters = three_groups();
    parameters.mutate_group = GeneGroup::Free;
    std::vector<float> genes = middle_of_bounds(parameters);
    genes[BodySize] = 5000;
    genes[body_gene_count] = -100; // a weight of the brain
    base::RandomStream random = stream_of(228);
    EXPECT_EQ(ValueMutation<>{parameters}.apply(genes, random), 2u);
    EXPECT_EQ(genes[BodySize], 1000);
    EXPECT_EQ(genes[body_gene_count], -4);
}

} // namespace
} // namespace evod::evolution
