#include "server/evolution/order_mutation.h"

#include "tests/unit/evolution/draws.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace evod::evolution {
namespace {

using Order = std::array<float, body_gene_count>;
constexpr Order in_order = {0, 1, 2, 3, 4, 5};

Parameters with(OrderMutationMethod method, double chance = 1) {
    Parameters parameters;
    parameters.rearranging = method;
    parameters.rearrange_chance = chance;
    return parameters;
}

std::map<Order, std::uint64_t> outcomes(const Parameters& parameters, std::uint32_t draws, std::uint64_t seed) {
    const OrderMutation mutation{parameters};
    std::map<Order, std::uint64_t> counts;
    for (std::uint32_t i = 0; i < draws; ++i) {
        Order genes = in_order;
        base::RandomStream random = stream_of(seed, i);
        mutation.apply(Genes{genes}, random);
        ++counts[genes];
    }
    return counts;
}

using Law = std::map<Order, double>;

/// Pearson's test of the outcomes against the probabilities of all of them.
double p_value_of(std::map<Order, std::uint64_t> counts, const Law& law) {
    std::vector<std::uint64_t> observed;
    std::vector<double> expected;
    for (const auto& [order, probability] : law) {
        observed.push_back(counts[order]);
        expected.push_back(probability);
        counts.erase(order);
    }
    return counts.empty() ? p_value_of_law(observed, expected) : 0; // 0: an outcome that the law excludes
}

Order swapped(Order order, unsigned a, unsigned b) {
    std::swap(order[a], order[b]);
    return order;
}

template <class Visit>
void for_each_pair(const Visit& visit) { // 15 of them
    for (unsigned a = 0; a < body_gene_count; ++a) {
        for (unsigned b = a + 1; b < body_gene_count; ++b) {
            visit(a, b);
        }
    }
}

TEST(Swap, TradesOneOrTwoPairsWithEvenChance) {
    // Law: half of a uniform transposition, half of the product of two: 101 orders. Chi-square, 100 degrees of freedom.
    Law law;
    for_each_pair([&](unsigned a, unsigned b) {
        const Order once = swapped(in_order, a, b);
        law[once] += 0.5 / 15;
        for_each_pair([&](unsigned c, unsigned d) { law[swapped(once, c, d)] += 0.5 / 15 / 15; });
    });
    ASSERT_EQ(law.size(), 101u);
    EXPECT_GT(p_value_of(outcomes(with(OrderMutationMethod::Swap), 500'000, 191), law), alpha);
}

TEST(Scramble, PutsASliceInAnyOrder) {
    // Law: the slice uniform among 15, its order uniform among all. Chi-square, 719 degrees of freedom.
    Law law;
    for_each_pair([&](unsigned a, unsigned b) {
        Order order = in_order;
        double orders = 1;
        for (unsigned i = 2; i <= b - a + 1; ++i) {
            orders *= i;
        }
        do {
            law[order] += 1 / orders / 15;
        } while (std::next_permutation(order.begin() + a, order.begin() + b + 1));
    });
    ASSERT_EQ(law.size(), 720u);
    EXPECT_NEAR(law[in_order], 2383.0 / 10800, 1e-12);
    EXPECT_GT(p_value_of(outcomes(with(OrderMutationMethod::Scramble), 2'000'000, 192), law), alpha);
}

TEST(Scramble, LeavesChromosomesUnchangedAsOftenAsComputed) {
    // Law: 2383/10800. Chi-square, 1 degree of freedom.
    const std::uint64_t unchanged = outcomes(with(OrderMutationMethod::Scramble), 1'000'000, 193)[in_order];
    EXPECT_GT(
        p_value_of_law(std::vector{unchanged, 1'000'000 - unchanged}, std::vector{2383.0 / 10800, 1 - 2383.0 / 10800}),
        alpha);
}

TEST(Inversion, ReversesEachOfThe15SlicesEquallyOften) {
    // Law: 1/15 for each. Chi-square, 14 degrees of freedom.
    Law law;
    for_each_pair([&](unsigned a, unsigned b) {
        Order order = in_order;
        std::reverse(order.begin() + a, order.begin() + b + 1);
        law[order] += 1 / 15.0;
    });
    ASSERT_EQ(law.size(), 15u);
    EXPECT_GT(p_value_of(outcomes(with(OrderMutationMethod::Inversion), 150'000, 194), law), alpha);
}

TEST(OrderMutation, HappensWithItsChance) {
    // Law: inversion always changes something, so a share of 0.2 is changed. Chi-square, 1 degree of freedom.
    const std::uint64_t unchanged = outcomes(with(OrderMutationMethod::Inversion, 0.2), 200'000, 195)[in_order];
    EXPECT_GT(p_value_of_law(std::vector{unchanged, 200'000 - unchanged}, std::vector{0.8, 0.2}), alpha);
    EXPECT_EQ(outcomes(with(OrderMutationMethod::None, 1), 100, 196)[in_order], 100u);
    EXPECT_EQ(outcomes(with(OrderMutationMethod::Scramble, 0), 100, 197)[in_order], 100u);
    EXPECT_TRUE(OrderMutation{with(OrderMutationMethod::Swap, 0)}.is_off());
}

RC_GTEST_PROP(OrderMutation, NeverMakesANewValue, ()) {
    Order genes;
    for (float& gene : genes) {
        gene = static_cast<float>(*rc::gen::inRange(0, 8)); // equal values included
    }
    Order rearranged = genes;
    const auto method =
        *rc::gen::element(OrderMutationMethod::Swap, OrderMutationMethod::Scramble, OrderMutationMethod::Inversion);
    base::RandomStream random = stream_of(*rc::gen::arbitrary<std::uint64_t>());
    OrderMutation{with(method)}.apply(Genes{rearranged}, random);
    std::sort(genes.begin(), genes.end());
    std::sort(rearranged.begin(), rearranged.end());
    RC_ASSERT(genes == rearranged);
}

// Chromosomes of any length. The results are observed as the genes' present indices.

/// Calls `visit` with each of `count` orders of 0 … genes − 1.
template <class Visit>
void wide_orders(OrderMutationMethod method, unsigned genes, std::uint32_t count, std::uint64_t seed,
                 const Visit& visit) {
    Parameters parameters = wide_parameters(genes);
    parameters.rearranging = method;
    parameters.rearrange_chance = 1;
    const OrderMutation mutation{parameters};
    std::vector<std::uint32_t> order(genes);
    for (std::uint32_t i = 0; i < count; ++i) {
        std::iota(order.begin(), order.end(), 0u);
        base::RandomStream random = stream_of(seed, i);
        ASSERT_TRUE(mutation.apply(std::span{order}, random));
        visit(order);
    }
}

/// The index of a pair a < b among all pairs of `genes` genes.
std::size_t pair_index(std::size_t a, std::size_t b) {
    return b * (b - 1) / 2 + a;
}

/// The first and the last gene that moved; both 0 if none did.
std::pair<std::size_t, std::size_t> moved_ends(const std::vector<std::uint32_t>& order) {
    std::size_t first = 0, last = 0;
    for (std::size_t gene = order.size(); gene-- > 0;) {
        if (order[gene] != gene) {
            first = gene;
            last = std::max(last, gene);
        }
    }
    return {first, last};
}

TEST(WideSwap, TradesOneOrTwoPairsWithEvenChance) {
    // Law: half of a uniform transposition, half of the product of two. Chi-square over the pairs, and the products by
    // the number of genes that moved: none, three or four.
    for (const unsigned genes : wide_gene_counts) {
        const std::size_t pairs = genes * (genes - 1) / 2;
        std::vector<std::uint64_t> counts(pairs + 3);
        wide_orders(OrderMutationMethod::Swap, genes, 40'000, 198, [&](const auto& order) {
            unsigned moved = 0;
            for (unsigned gene = 0; gene < genes; ++gene) {
                moved += order[gene] != gene;
            }
            const auto [first, last] = moved_ends(order);
            ++counts[moved == 2 ? pair_index(first, last) : pairs + (moved == 0 ? 0 : moved - 2)];
        });
        const auto all = static_cast<double>(pairs), rest = static_cast<double>(genes - 2);
        std::vector<double> law(pairs, 0.5 / all);
        law.insert(law.end(), {0.5 / all, 0.5 * 2 * rest / all, 0.5 * rest * (rest - 1) / 2 / all});
        EXPECT_GT(p_value_of_joined_cells(counts, law), alpha) << genes;
    }
}

TEST(WideInversion, ReversesEachSliceEquallyOften) {
    // Law: each slice of at least two genes. Chi-square over the slices.
    for (const unsigned genes : wide_gene_counts) {
        std::vector<std::uint64_t> counts(genes * (genes - 1) / 2);
        wide_orders(OrderMutationMethod::Inversion, genes, 40'000, 199, [&](const auto& order) {
            const auto [first, last] = moved_ends(order);
            for (std::size_t gene = first; gene <= last; ++gene) {
                ASSERT_EQ(order[gene], first + last - gene);
            }
            ++counts.at(pair_index(first, last));
        });
        const std::vector<double> law(counts.size(), 1 / static_cast<double>(counts.size()));
        EXPECT_GT(p_value_of_joined_cells(counts, law), alpha) << genes;
    }
}

TEST(WideScramble, MovesAGeneToAnyPlaceOfTheSlice) {
    // Law: each slice [a, b] equally likely, and each place in it. Chi-square over the place at which one gene ends; a
    // gene outside the slice stays.
    for (const unsigned genes : wide_gene_counts) {
        for (const unsigned gene : {0u, genes / 2, genes - 1}) {
            std::vector<double> law(genes);
            const double slices = genes * (genes - 1) / 2;
            for (unsigned a = 0; a < genes; ++a) {
                for (unsigned b = a + 1; b < genes; ++b) {
                    if (a <= gene && gene <= b) {
                        for (unsigned place = a; place <= b; ++place) {
                            law[place] += 1 / slices / (b - a + 1);
                        }
                    } else {
                        law[gene] += 1 / slices;
                    }
                }
            }
            std::vector<std::uint64_t> counts(genes);
            wide_orders(OrderMutationMethod::Scramble, genes, 20'000, 200, [&](const auto& order) {
                ++counts[static_cast<std::size_t>(std::ranges::find(order, gene) - order.begin())];
            });
            EXPECT_GT(p_value_of_joined_cells(counts, law), alpha) << genes << ", gene " << gene;
        }
    }
}

TEST(MutateGroup, LimitsOrderMutationToItsGenes) {
    // Law: each slice of the group equally likely. Chi-square over the slices.
    for (const GeneGroup group : {GeneGroup::Body, GeneGroup::Brain, GeneGroup::Free}) {
        Parameters parameters = with(OrderMutationMethod::Inversion);
        parameters.controller = Controller::Network;
        parameters.free_genes = 20;
        parameters.mutate_group = group;
        const GeneRange range = genes_of(group, parameters);
        const OrderMutation mutation{parameters};
        std::vector<std::uint32_t> order(gene_count(parameters));
        std::vector<std::uint64_t> counts(range.count * (range.count - 1) / 2);
        for (std::uint32_t i = 0; i < 20'000; ++i) {
            std::iota(order.begin(), order.end(), 0u);
            base::RandomStream random = stream_of(229, i);
            ASSERT_TRUE(mutation.apply(std::span{order}, random));
            const auto [first, last] = moved_ends(order);
            ASSERT_GE(first, range.first);
            ASSERT_LT(last, range.first + range.count);
            ++counts.at(pair_index(first - range.first, last - range.first));
        }
        EXPECT_GT(support::p_value_of_equal_cells(counts), alpha) << static_cast<int>(group);
    }
}

TEST(MutateGroup, OneGeneHasNoOrder) {
    Parameters parameters = with(OrderMutationMethod::Scramble);
    parameters.free_genes = 1;
    parameters.mutate_group = GeneGroup::Free;
    std::vector<std::uint32_t> order = {0, 1, 2, 3, 4, 5, 6};
    base::RandomStream random = stream_of(230);
    EXPECT_FALSE(OrderMutation{parameters}.apply(std::span{order}, random));
    EXPECT_EQ(moved_ends(order), (std::pair<std::size_t, std::size_t>{0, 0}));
}

} // namespace
} // namespace evod::evolution
