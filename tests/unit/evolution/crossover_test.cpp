#include "server/evolution/crossover.h"

#include "tests/unit/evolution/draws.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <bit>
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
    const Crossover crossover{parameters};
    std::vector<std::uint64_t> counts(64);
    for (std::uint32_t i = 0; i < draws; ++i) {
        base::RandomStream random = stream_of(seed, i);
        ++counts.at(crossover.draw(random).value_or(0));
    }
    return counts;
}

/// The masks with `cuts` changes of parent that begin with parent 0, each with the same probability.
std::vector<double> law_of_cuts(int cuts) {
    std::vector<double> law(64);
    double reached = 0;
    for (GeneMask mask = 0; mask < 64; mask += 2) {
        if (std::popcount((mask ^ mask << 1) & 62) == cuts) {
            ++reached;
        }
    }
    for (GeneMask mask = 0; mask < 64; mask += 2) {
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
    for (const GeneMask mask : {0b111110, 0b111100, 0b111000, 0b110000, 0b100000}) {
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
    EXPECT_EQ(mask_of_cuts(0b000100), 0b111100u);
    EXPECT_EQ(mask_of_cuts(0b100010), 0b011110u);
    EXPECT_EQ(mask_of_cuts(0b111110), 0b101010u);
    EXPECT_EQ(mask_of_cuts(0), 0u);
}

RC_GTEST_PROP(Crossover, ChildrenAreComplementary, ()) {
    std::array<float, gene_count> first, second, child, sibling;
    for (unsigned gene = 0; gene < gene_count; ++gene) {
        first[gene] = static_cast<float>(*rc::gen::inRange(0, 1000));
        second[gene] = static_cast<float>(*rc::gen::inRange(0, 1000));
    }
    const GeneMask mask = *rc::gen::inRange(0u, 64u);
    cross(first, second, mask, child);
    cross(first, second, ~mask, sibling);
    for (unsigned gene = 0; gene < gene_count; ++gene) {
        const bool from_second = (mask >> gene & 1) != 0;
        RC_ASSERT(child[gene] == (from_second ? second : first)[gene]);
        RC_ASSERT(sibling[gene] == (from_second ? first : second)[gene]);
    }
}

} // namespace
} // namespace evod::evolution
