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
    // Law: with probability 0.6 one of the 6 genes, each equally likely, is multiplied by a factor uniform in (0.75, 1.25).
    // Chi-square over 6 × 50 cells and the chromosomes without a change, 300 degrees of freedom; the factor of 1 itself has
    // probability 1e-7.
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

TEST(Bounds, NothingIsCountedIfNoGeneIsOutside) {
    mutants({}, {100, 100, 100, 100, 100, 100}, 1000, 208,
            [](const Values&, unsigned clamped) { ASSERT_EQ(clamped, 0u); });
}

} // namespace
} // namespace evod::evolution
