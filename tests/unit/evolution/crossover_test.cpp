#include "server/evolution/crossover.h"

#include "tests/unit/evolution/draws.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cmath>
#include <set>

namespace evod::evolution {
namespace {

Parameters with(CrossoverMethod method, std::uint32_t cuts = 2, double chance = 1) {
    Parameters parameters;
    parameters.crossover = method;
    parameters.crossover_cuts = cuts;
    parameters.crossover_chance = chance;
    return parameters;
}

std::vector<std::uint64_t> masks(const Parameters& parameters, std::uint32_t draws, std::uint64_t seed) {
    const Crossover<body_gene_count> crossover{parameters, body_gene_count};
    std::vector<std::uint64_t> counts(64);
    for (std::uint32_t i = 0; i < draws; ++i) {
        base::RandomStream random = stream_of(seed, i);
        Mixture<body_gene_count> mixture{body_gene_count};
        crossover.draw(mixture, random);
        ++counts.at(mixture.from_second.words()[0]);
    }
    return counts;
}

/// The masks with `cuts` changes of parent that begin with parent 0, each with the same probability.
std::vector<double> law_of_cuts(int cuts) {
    std::vector<double> law(64);
    double reached = 0;
    for (unsigned mask = 0; mask < 64; mask += 2) {
        if (std::popcount((mask ^ mask << 1) & 62) == cuts) {
            ++reached;
        }
    }
    for (unsigned mask = 0; mask < 64; mask += 2) {
        if (std::popcount((mask ^ mask << 1) & 62) == cuts) {
            law[mask] = 1 / reached;
        }
    }
    return law;
}

TEST(Crossover, UniformDrawsEachOfThe64MasksEquallyOften) {
    // Chi-square, 63 degrees of freedom.
    EXPECT_GT(support::p_value_of_equal_cells(masks(with(CrossoverMethod::Uniform), 640'000, 181)), alpha);
}

TEST(Crossover, SinglePointDrawsEachCutEquallyOften) {
    // Law: 1/5 for each of 000001 … 011111 read from the last gene. Chi-square, 4 degrees of freedom.
    std::vector<double> law(64);
    for (const unsigned mask : {0b111110, 0b111100, 0b111000, 0b110000, 0b100000}) {
        law[mask] = 0.2;
    }
    EXPECT_GT(p_value_of_law(masks(with(CrossoverMethod::SinglePoint), 200'000, 182), law), alpha);
}

TEST(Crossover, MultiPointDrawsEachSetOfCutsEquallyOften) {
    // Law: 1/C(5, k) for each of the C(5, k) masks; 10 for the default of two cuts. Chi-square.
    for (std::uint32_t cuts = 1; cuts <= 4; ++cuts) {
        const auto law = law_of_cuts(static_cast<int>(cuts));
        EXPECT_GT(p_value_of_law(masks(with(CrossoverMethod::MultiPoint, cuts), 200'000, 183), law), alpha) << cuts;
    }
    EXPECT_EQ(std::ranges::count(law_of_cuts(2), 0.1), 10);
    EXPECT_EQ(masks(with(CrossoverMethod::MultiPoint, 5), 1000, 184)[0b101010], 1000u);
}

TEST(Crossover, NoneNeverMixes) {
    EXPECT_EQ(masks(with(CrossoverMethod::None), 1000, 185)[0], 1000u);
}

TEST(Crossover, HappensWithItsChance) {
    // Law: mask 0 with probability 0.3, each of the 10 others with 0.07. Chi-square, 10 degrees of freedom.
    auto law = law_of_cuts(2);
    for (double& probability : law) {
        probability *= 0.7;
    }
    law[0] = 0.3;
    EXPECT_GT(p_value_of_law(masks(with(CrossoverMethod::MultiPoint, 2, 0.7), 200'000, 186), law), alpha);
    EXPECT_EQ(masks(with(CrossoverMethod::SinglePoint, 2, 0), 1000, 187)[0], 1000u);
}

TEST(Crossover, TheParentChangesAtEveryCut) {
    const auto mask_of = [](std::uint32_t cuts, std::uint64_t index) {
        return Crossover<>{with(CrossoverMethod::MultiPoint, cuts), body_gene_count}.mask_of_cuts(index).words()[0];
    };
    EXPECT_EQ(mask_of(1, 1), 0b111100u);
    EXPECT_EQ(mask_of(2, 0), 0b000010u);
    EXPECT_EQ(mask_of(2, 6), 0b011110u);
    EXPECT_EQ(mask_of(5, 0), 0b101010u);
}

TEST(Crossover, EverySetOfCutsHasOneIndex) {
    for (const unsigned genes : {6u, 10u, 64u, 65u}) {
        for (std::uint32_t cuts = 1; cuts <= 2; ++cuts) {
            const Crossover<> crossover{with(CrossoverMethod::MultiPoint, cuts), genes};
            const std::uint64_t sets = cuts == 1 ? genes - 1 : std::uint64_t{genes - 1} * (genes - 2) / 2;
            std::set<std::vector<std::uint32_t>> seen;
            for (std::uint64_t index = 0; index < sets; ++index) {
                const GeneMask<> mask = crossover.mask_of_cuts(index);
                unsigned changes = 0;
                ASSERT_FALSE(mask.contains(0));
                for (unsigned gene = 1; gene < genes; ++gene) {
                    changes += mask.contains(gene) != mask.contains(gene - 1);
                }
                ASSERT_EQ(changes, cuts);
                seen.emplace(mask.words().begin(), mask.words().end());
            }
            EXPECT_EQ(seen.size(), sets) << genes;
        }
    }
}

TEST(Crossover, AnyNumberOfGenesIsCutEquallyOften) {
    // Law: each of the genes − 1 cuts equally likely. Chi-square.
    for (const unsigned genes : wide_gene_counts) {
        const Crossover<> crossover{with(CrossoverMethod::SinglePoint), genes};
        std::vector<std::uint64_t> counts(genes - 1);
        for (std::uint32_t i = 0; i < 100'000; ++i) {
            base::RandomStream random = stream_of(189, i);
            Mixture<> mixture{genes};
            ASSERT_TRUE(crossover.draw(mixture, random));
            ++counts.at(genes - 1 - mixture.from_second.count());
        }
        EXPECT_GT(support::p_value_of_equal_cells(counts), alpha) << genes;
    }
}

TEST(Crossover, UniformGivesEachOfAnyNumberOfGenesEquallyOften) {
    // Law: each gene from the second parent with probability 1/2: chi-square, one degree of freedom per gene. Genes are
    // independent, so the number from the second parent is binomial: chi-square over its values.
    for (const unsigned genes : wide_gene_counts) {
        const Crossover<> crossover{with(CrossoverMethod::Uniform), genes};
        std::vector<std::vector<std::uint64_t>> of_gene(genes, std::vector<std::uint64_t>(2));
        std::vector<std::uint64_t> counts(genes + 1);
        for (std::uint32_t i = 0; i < 50'000; ++i) {
            base::RandomStream random = stream_of(190, i);
            Mixture<> mixture{genes};
            crossover.draw(mixture, random);
            ++counts[mixture.from_second.count()];
            for (unsigned gene = 0; gene < genes; ++gene) {
                ++of_gene[gene][mixture.from_second.contains(gene)];
            }
        }
        EXPECT_GT(p_value_of_rows(of_gene, std::vector{0.5, 0.5}), alpha) << genes;
        EXPECT_GT(p_value_of_joined_cells(counts, binomial_law(genes, 0.5)), alpha) << genes;
    }
}

/// The number of subsets of `chosen` out of `count` elements.
double subsets(unsigned count, unsigned chosen) {
    double number = 1;
    for (unsigned i = 0; i < chosen; ++i) {
        number *= count > i ? static_cast<double>(count - i) / (i + 1) : 0;
    }
    return number;
}

TEST(Crossover, MultiPointCutsAnyNumberOfGenesEquallyOften) {
    // Law: each set of k of the genes − 1 cuts equally likely, so the r-th cut is before gene m with probability
    // C(m − 1, r − 1) C(genes − 1 − m, k − r) / C(genes − 1, k). Chi-square over m, for each r. 1,328 genes are the
    // most that a chromosome can have.
    for (const unsigned genes : {10u, 64u, 65u, 328u, 1328u}) {
        for (unsigned cuts = 2; cuts <= 5; ++cuts) {
            const Crossover<> crossover{with(CrossoverMethod::MultiPoint, cuts), genes};
            std::vector<std::vector<std::uint64_t>> counts(cuts, std::vector<std::uint64_t>(genes));
            for (std::uint32_t i = 0; i < 10'000; ++i) {
                base::RandomStream random = stream_of(180, i);
                Mixture<> mixture{genes};
                ASSERT_TRUE(crossover.draw(mixture, random));
                ASSERT_FALSE(mixture.from_second.contains(0));
                unsigned cut = 0;
                for (unsigned gene = 1; gene < genes; ++gene) {
                    if (mixture.from_second.contains(gene) != mixture.from_second.contains(gene - 1)) {
                        ++counts.at(cut++)[gene];
                    }
                }
                ASSERT_EQ(cut, cuts);
            }
            for (unsigned r = 1; r <= cuts; ++r) {
                std::vector<double> law(genes);
                for (unsigned m = 1; m < genes; ++m) {
                    law[m] = subsets(m - 1, r - 1) * subsets(genes - 1 - m, cuts - r) / subsets(genes - 1, cuts);
                }
                EXPECT_GT(p_value_of_joined_cells(counts[r - 1], law), alpha)
                    << genes << " genes, cut " << r << " of " << cuts;
            }
        }
    }
}

RC_GTEST_PROP(Crossover, ChildrenAreComplementary, ()) {
    const unsigned genes = *rc::gen::element(6u, 10u, 64u, 65u, 328u);
    std::vector<float> first(genes), second(genes), child(genes), sibling(genes);
    for (unsigned gene = 0; gene < genes; ++gene) {
        first[gene] = static_cast<float>(gene);
        second[gene] = static_cast<float>(gene) + 1000;
    }
    Mixture<> mixture{genes};
    base::RandomStream random = stream_of(*rc::gen::inRange<std::uint64_t>(0, 1000));
    const auto method =
        *rc::gen::element(CrossoverMethod::Uniform, CrossoverMethod::SinglePoint, CrossoverMethod::MultiPoint);
    Crossover<>{with(method), genes}.draw(mixture, random);
    GeneMask<> mask = mixture.from_second;
    cross(ConstGenes{first}, ConstGenes{second}, mask, Genes{child});
    mask.complement();
    cross(ConstGenes{first}, ConstGenes{second}, mask, Genes{sibling});
    for (unsigned gene = 0; gene < genes; ++gene) {
        const bool from_second = mixture.from_second.contains(gene);
        RC_ASSERT(child[gene] == (from_second ? second : first)[gene]);
        RC_ASSERT(sibling[gene] == (from_second ? first : second)[gene]);
    }
}

TEST(Crossover, BlendDrawsAUniformWeight) {
    // Law: with probability 0.8 uniform in (0, 1), otherwise no crossover. Chi-square over 100 cells and the pairs
    // without crossover, 100 degrees of freedom.
    for (const unsigned genes : {6u, 10u, 64u, 65u, 328u}) {
        const Crossover<> crossover{with(CrossoverMethod::Blend, 2, 0.8), genes};
        std::vector<std::uint64_t> counts(101);
        for (std::uint32_t i = 0; i < 100'000; ++i) {
            base::RandomStream random = stream_of(188, i);
            Mixture<> mixture{genes};
            if (!crossover.draw(mixture, random)) {
                ++counts[100];
                continue;
            }
            const double share = mixture.second_share;
            ASSERT_GT(share, 0);
            ASSERT_LT(share, 0.5);
            ASSERT_TRUE(mixture.from_second.count() == 0 || mixture.from_second.count() == genes);
            ++counts[static_cast<std::size_t>((mixture.from_second.count() == 0 ? share : 1 - share) * 100)];
        }
        std::vector<double> law(101, 0.008);
        law[100] = 0.2;
        EXPECT_GT(p_value_of_law(counts, law), alpha) << genes;
    }
}

RC_GTEST_PROP(Crossover, BlendedSiblingsHaveTheMeanOfTheirParents, ()) {
    const unsigned genes = *rc::gen::element(6u, 10u, 64u, 65u, 328u);
    std::vector<float> first(genes), second(genes), child(genes), sibling(genes);
    const auto draw = [] {
        const auto size = static_cast<float>(*rc::gen::inRange(0, 1 << 24));
        return std::ldexp(*rc::gen::arbitrary<bool>() ? size : -size, *rc::gen::inRange(-30, -8));
    };
    for (unsigned gene = 0; gene < genes; ++gene) {
        first[gene] = draw();
        second[gene] = draw();
    }
    const double share = (*rc::gen::inRange(0u, 0x7fff'ffffu) + 0.5) * 0x1p-32;
    blend(ConstGenes{first}, ConstGenes{second}, share, Genes{child});
    blend(ConstGenes{second}, ConstGenes{first}, share, Genes{sibling});
    for (unsigned gene = 0; gene < genes; ++gene) {
        const double a = double{first[gene]}, b = double{second[gene]};
        const double one = double{child[gene]}, other = double{sibling[gene]};
        const double largest = std::max(std::abs(a), std::abs(b));
        RC_ASSERT(std::abs(one + other - (a + b)) <= 0x1p-23 * largest); // these sums are exact
        RC_ASSERT(one >= std::min(a, b));
        RC_ASSERT(one <= std::max(a, b));
        RC_ASSERT(std::abs(one - (a + share * (b - a))) <= 0x1p-23 * largest);
    }
}

TEST(Crossover, BlendingEqualParentsCopiesThem) {
    const std::array<float, body_gene_count> parent = {20, 33.3f, 1e-3f, 99.99f, 0, 250};
    std::array<float, body_gene_count> child{};
    blend(ConstGenes{parent}, ConstGenes{parent}, 0.3, Genes{child});
    EXPECT_EQ(child, parent);
}

/// Bounds −1 … 1 of so many genes.
GeneBounds unit_bounds(unsigned genes) {
    return {Eigen::ArrayXf::Constant(genes, -1), Eigen::ArrayXf::Constant(genes, 1)};
}

/// What simulated binary crossover makes of parents that have all genes at `first` and at `second`; visit(child,
/// sibling) is called for each gene that was spread.
template <class Visit>
void spread_often(float first, float second, double index, std::uint64_t seed, const Visit& visit) {
    constexpr unsigned genes = 40;
    const Crossover<> crossover{with(CrossoverMethod::SimulatedBinary), genes};
    const GeneBounds bounds = unit_bounds(genes);
    const std::vector<float> one(genes, first), other(genes, second);
    std::vector<float> child(genes), sibling(genes);
    for (std::uint32_t pair = 0; pair < 10'000; ++pair) {
        base::RandomStream random = stream_of(seed, pair);
        Mixture<> mixture{genes};
        ASSERT_TRUE(crossover.draw(mixture, random));
        spread(ConstGenes{one}, ConstGenes{other}, mixture.from_second, *mixture.spreads, bounds, index, Genes{child});
        mixture.from_second.complement();
        spread(ConstGenes{one}, ConstGenes{other}, mixture.from_second, *mixture.spreads, bounds, index,
               Genes{sibling});
        for (unsigned gene = 0; gene < genes; ++gene) {
            ASSERT_TRUE(child[gene] >= -1 && child[gene] <= 1 && sibling[gene] >= -1 && sibling[gene] <= 1);
            visit(double{child[gene]}, double{sibling[gene]});
        }
    }
}

TEST(Crossover, SimulatedBinaryFollowsTheLawOfItsSpread) {
    // Law: a gene is spread with probability 1/2. Its β = |difference of the children| / |difference of the parents|
    // has the cumulative probability β^(n + 1) / 2 up to 1, and 1 − β^−(n + 1) / 2 beyond. The parents are so near to
    // each other that the bounds cut off less than 1e-9. Chi-square over 20 equally likely cells, 19 degrees of
    // freedom.
    for (const double index : {2.0, 15.0}) {
        std::vector<std::uint64_t> cells(20);
        std::uint64_t copies = 0, swaps = 0, spreads = 0;
        spread_often(-0x1p-12f, 0x1p-12f, index, 191, [&](double child, double sibling) {
            ASSERT_NEAR(child + sibling, 0, 0x1p-30); // the mean of the parents
            const double beta = std::abs(child - sibling) / 0x1p-11;
            if (beta == 1) {
                ++copies;
                return;
            }
            ++spreads;
            swaps += child > sibling;
            const double below = beta <= 1 ? std::pow(beta, index + 1) / 2 : 1 - std::pow(beta, -index - 1) / 2;
            ++cells.at(std::min<std::size_t>(19, static_cast<std::size_t>(20 * below)));
        });
        EXPECT_GT(support::p_value_of_equal_cells(cells), alpha) << index;
        const std::uint64_t halves[] = {copies, spreads}, sides[] = {swaps, spreads - swaps};
        EXPECT_GT(support::p_value_of_equal_cells(halves), alpha) << index;
        EXPECT_GT(support::p_value_of_equal_cells(sides), alpha) << index;
    }
}

TEST(Crossover, SimulatedBinaryIsCutOffAtTheBounds) {
    // Law: the lower child of −0.9 and 0.1, bounded by −1, has β <= 1.2, so its cumulative probability is that of the
    // unbounded law divided by that of 1.2. Chi-square over 20 equally likely cells, 19 degrees of freedom.
    const double index = 2;
    const auto below = [&](double beta) {
        return beta <= 1 ? std::pow(beta, index + 1) / 2 : 1 - std::pow(beta, -index - 1) / 2;
    };
    std::vector<std::uint64_t> cells(20);
    spread_often(-0.9f, 0.1f, index, 192, [&](double child, double sibling) {
        const double lower = std::min(child, sibling);
        if (lower != double{-0.9f}) {
            const double beta = (-0.4 - lower) / 0.5;
            ++cells.at(std::min<std::size_t>(19, static_cast<std::size_t>(20 * below(beta) / below(1.2))));
        }
    });
    EXPECT_GT(support::p_value_of_equal_cells(cells), alpha);
}

TEST(Crossover, SimulatedBinaryCopiesEqualParents) {
    spread_often(0.3f, 0.3f, 15, 193, [](double child, double sibling) {
        ASSERT_EQ(child, double{0.3f});
        ASSERT_EQ(sibling, double{0.3f});
    });
    // Parents beyond the bounds, which were narrowed since: what is spread is within.
    spread_often(-1, 1, 0, 194, [](double child, double sibling) { ASSERT_LE(std::abs(child - sibling), 2); });
}

} // namespace
} // namespace evod::evolution
