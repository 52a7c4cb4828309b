#include "server/evolution/migration.h"

#include "tests/unit/evolution/draws.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace evod::evolution {
namespace {

constexpr base::Seed seed{211};

Parameters with(Topology topology, std::uint32_t migrant_count = 1) {
    Parameters parameters;
    parameters.migration = topology;
    parameters.migrant_count = migrant_count;
    return parameters;
}

/// The fitness of islands of the given populations. On each island organism i has fitness i, so the last is the best.
class Islands {
  public:
    explicit Islands(std::initializer_list<std::uint32_t> populations) {
        for (const std::uint32_t population : populations) {
            fitness_.emplace_back();
            for (std::uint32_t i = 0; i < population; ++i) {
                fitness_.back().push_back(i);
            }
        }
        spans_.assign(fitness_.begin(), fitness_.end());
    }
    std::vector<Migrant> migrants(const Parameters& parameters, std::uint64_t generation = 10) const {
        return choose_migrants(spans_, parameters, seed, generation);
    }

  private:
    std::vector<std::vector<double>> fitness_;
    std::vector<std::span<const double>> spans_;
};

TEST(Migration, IsDueOncePerEpoch) {
    Parameters parameters = with(Topology::Ring);
    parameters.migration_epoch = 3;
    std::vector<std::uint64_t> due;
    for (std::uint64_t generation = 1; generation <= 9; ++generation) {
        if (migration_due(generation, parameters)) {
            due.push_back(generation);
        }
    }
    EXPECT_EQ(due, (std::vector<std::uint64_t>{3, 6, 9}));
    EXPECT_FALSE(migration_due(3, with(Topology::None)));
}

TEST(Migration, RingSendsTheBestToReplaceTheNextIslandsWorst) {
    const Islands islands{5, 4, 3};
    EXPECT_EQ(
        islands.migrants(with(Topology::Ring, 2)),
        (std::vector<Migrant>{{2, 0, 2, 0}, {2, 0, 1, 1}, {0, 1, 4, 0}, {0, 1, 3, 1}, {1, 2, 3, 0}, {1, 2, 2, 1}}));
}

TEST(Migration, FullyConnectedSendsAlongEveryEdgeInOrder) {
    const auto migrants = Islands{9, 9, 9}.migrants(with(Topology::FullyConnected));
    EXPECT_EQ(migrants, (std::vector<Migrant>{
                            {1, 0, 8, 0}, {2, 0, 8, 1}, {0, 1, 8, 0}, {2, 1, 8, 1}, {0, 2, 8, 0}, {1, 2, 8, 1}}));
}

TEST(Migration, RandomSendsToOneOtherIslandEachEquallyOften) {
    // Law: 1/3 for each of the others of 4 islands. Chi-square over 4 · 3 cells for 4 independent rows, so 8 degrees of
    // freedom.
    const Islands islands{3, 3, 3, 3};
    std::vector<std::uint64_t> counts(12);
    constexpr std::uint64_t generations = 30'000;
    for (std::uint64_t generation = 1; generation <= generations; ++generation) {
        std::set<std::uint32_t> senders;
        for (const Migrant& migrant : islands.migrants(with(Topology::Random), generation)) {
            ASSERT_NE(migrant.from, migrant.to);
            ASSERT_TRUE(senders.insert(migrant.from).second);
            ++counts[migrant.from * 3 + migrant.to - (migrant.to > migrant.from)];
        }
        ASSERT_EQ(senders.size(), 4u);
    }
    const std::vector<double> expected(12, generations / 3.0);
    EXPECT_GT(support::p_value(support::chi_square(counts, expected), 8), alpha);
}

TEST(Migration, NeedsATopologyAndASecondIsland) {
    EXPECT_TRUE((Islands{5, 5}.migrants(with(Topology::None)).empty()));
    for (const Topology topology : {Topology::Ring, Topology::FullyConnected, Topology::Random}) {
        EXPECT_TRUE(Islands{5}.migrants(with(topology)).empty());
        EXPECT_TRUE(Islands{}.migrants(with(topology)).empty());
    }
}

TEST(Migration, RandomEmigrantsAreDifferentAndUniform) {
    // Law: each ordered pair of 4 organisms, 12, equally likely. Chi-square, 11 degrees of freedom.
    Parameters parameters = with(Topology::Ring, 2);
    parameters.emigrants = Emigrants::Random;
    const Islands islands{4, 4};
    std::vector<std::uint64_t> counts(12);
    for (std::uint64_t generation = 1; generation <= 30'000; ++generation) {
        const auto migrants = islands.migrants(parameters, generation);
        const std::uint32_t a = migrants[0].organism, b = migrants[1].organism;
        ASSERT_NE(a, b);
        ++counts[a * 3 + b - (b > a)];
    }
    EXPECT_GT(support::p_value_of_equal_cells(counts), alpha);
}

TEST(Migration, ReplacedAtRandomAreDifferentAndUniform) {
    // Law: each ordered pair of 4 organisms, 12, equally likely. Chi-square, 11 degrees of freedom.
    Parameters parameters = with(Topology::Ring, 2);
    parameters.immigrants_replace = Replaced::Random;
    const Islands islands{4, 4};
    std::vector<std::uint64_t> counts(12);
    for (std::uint64_t generation = 1; generation <= 30'000; ++generation) {
        const auto migrants = islands.migrants(parameters, generation);
        const std::uint32_t a = migrants[0].replaces, b = migrants[1].replaces;
        ASSERT_NE(a, b);
        ++counts[a * 3 + b - (b > a)];
    }
    EXPECT_GT(support::p_value_of_equal_cells(counts), alpha);
}

TEST(Migration, NoOrganismIsReplacedTwice) {
    const Islands islands{2, 6, 6, 0};
    for (const Replaced replaced : {Replaced::Worst, Replaced::Random}) {
        for (const std::uint32_t count : {1u, 2u, 5u, 100u}) {
            Parameters parameters = with(Topology::FullyConnected, count);
            parameters.immigrants_replace = replaced;
            std::set<std::pair<std::uint32_t, std::uint32_t>> places;
            std::map<std::uint32_t, std::uint32_t> arrived;
            for (const Migrant& migrant : islands.migrants(parameters)) {
                EXPECT_TRUE(places.insert({migrant.to, migrant.replaces}).second);
                ++arrived[migrant.to];
            }
            EXPECT_EQ(arrived[0], std::min(2u, 2 * std::min(count, 6u)));
            EXPECT_EQ(arrived[1], std::min(6u, std::min(count, 2u) + std::min(count, 6u)));
            EXPECT_EQ(arrived.count(3), 0u);
        }
    }
}

/// The number of migrants by islands: arrivals[to][from].
std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> arrivals_of(const std::vector<Migrant>& migrants) {
    std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> arrivals;
    for (const Migrant& migrant : migrants) {
        ++arrivals[migrant.to][migrant.from];
    }
    return arrivals;
}

TEST(Migration, NoEliteIsReplaced) {
    const Islands islands{5, 4, 3};
    for (const Replaced replaced : {Replaced::Worst, Replaced::Random}) {
        Parameters parameters = with(Topology::FullyConnected, 4);
        parameters.immigrants_replace = replaced;
        parameters.elite_count = 2;
        std::map<std::uint32_t, std::set<std::uint32_t>> places;
        for (const Migrant& migrant : islands.migrants(parameters)) {
            places[migrant.to].insert(migrant.replaces);
        }
        const std::map<std::uint32_t, std::set<std::uint32_t>> all_others{{0, {0, 1, 2}}, {1, {0, 1}}, {2, {0}}};
        EXPECT_EQ(places, all_others);
        parameters.elite_count = 9;
        EXPECT_TRUE(islands.migrants(parameters).empty());
    }
}

TEST(Migration, SharesPlacesEvenlyAmongOrigins) {
    const Islands islands{5, 7, 7, 2, 20, 0};
    const std::uint32_t populations[] = {5, 7, 7, 2, 20, 0};
    for (const Topology topology : {Topology::FullyConnected, Topology::Random}) {
        for (const Emigrants emigrants : {Emigrants::Best, Emigrants::Random}) {
            for (std::uint32_t count = 1; count <= 25; ++count) {
                Parameters parameters = with(topology, count);
                parameters.emigrants = emigrants;
                for (auto& [to, origins] : arrivals_of(islands.migrants(parameters, 10 * count))) {
                    for (std::uint32_t from = 0; topology == Topology::FullyConnected && from < 5; ++from) {
                        if (from != to) {
                            origins.try_emplace(from, 0);
                        }
                    }
                    std::uint32_t arrived = 0, most = 0;
                    for (const auto& [from, sent] : origins) {
                        arrived += sent;
                        most = std::max(most, sent);
                    }
                    EXPECT_LE(arrived, populations[to]);
                    for (const auto& [from, sent] : origins) {
                        const std::uint32_t wanted = std::min(count, populations[from]);
                        EXPECT_LE(sent, wanted);
                        EXPECT_TRUE(sent == wanted || (sent + 1 >= most && arrived == populations[to]))
                            << sent << " of " << wanted << " from " << from << " to " << to << ", most " << most;
                    }
                }
            }
        }
    }
}

TEST(Migration, DrawsTheOriginsThatGetRemainingPlaces) {
    // Law: each of three origins gets the remaining place with probability 1/3. Chi-square over 4 · 3 cells for 4
    // independent rows, so 8 degrees of freedom.
    for (const std::uint32_t population : {1u, 4u}) {
        const Islands islands{population, population, population, population};
        std::vector<std::uint64_t> counts(12);
        constexpr std::uint64_t generations = 9'000;
        for (std::uint64_t generation = 1; generation <= generations; ++generation) {
            for (const auto& [to, origins] :
                 arrivals_of(islands.migrants(with(Topology::FullyConnected, 4), generation))) {
                for (const auto& [from, sent] : origins) {
                    counts[to * 3 + from - (from > to)] += sent - population / 4; // each has its equal share
                }
            }
        }
        const std::vector<double> expected(12, generations / 3.0);
        EXPECT_GT(support::p_value(support::chi_square(counts, expected), 8), alpha) << population;
    }
}

TEST(Migration, EmigrantsAreCopiedBeforeAnyArrives) {
    GeneMatrix first = GeneMatrix::Constant(body_gene_count, 1, 1),
               second = GeneMatrix::Constant(body_gene_count, 1, 2);
    std::vector<double> first_fitness = {10}, second_fitness = {20};
    const IslandPopulation islands[] = {{&first, first_fitness}, {&second, second_fitness}};
    migrate(std::vector<Migrant>{{1, 0, 0, 0}, {0, 1, 0, 0}}, islands);
    EXPECT_TRUE((first == 2).all());
    EXPECT_TRUE((second == 1).all());
    EXPECT_EQ(first_fitness[0], 20);
    EXPECT_EQ(second_fitness[0], 10);
}

TEST(Migration, DependsOnSeedAndGeneration) {
    Parameters parameters = with(Topology::Random, 3);
    parameters.emigrants = Emigrants::Random;
    parameters.immigrants_replace = Replaced::Random;
    const Islands islands{20, 20, 20, 20};
    EXPECT_EQ(islands.migrants(parameters, 10), islands.migrants(parameters, 10));
    EXPECT_NE(islands.migrants(parameters, 10), islands.migrants(parameters, 20));
}

} // namespace
} // namespace evod::evolution
