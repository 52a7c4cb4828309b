#include "server/evolution/order_mutation.h"

#include "tests/unit/evolution/draws.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <map>

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

} // namespace
} // namespace evod::evolution
