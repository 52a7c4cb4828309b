#include "server/experiments/persistence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace evod::experiments {
namespace {

using simulation::ColonyStatistics;
using simulation::GenerationStatistics;

GenerationStatistics of_species(std::uint32_t alive, std::uint32_t lowest, double mean, std::uint32_t born) {
    GenerationStatistics statistics;
    statistics.alive_count = alive;
    statistics.colony = ColonyStatistics{.lowest_count = lowest, .count_mean = mean, .born_count = born};
    return statistics;
}

/// A run with the given numbers of living organisms; fewer than 0: the species has not come.
std::vector<SpeciesOfInterval> run_with(const std::vector<int>& prey, const std::vector<int>& predators) {
    std::vector<SpeciesOfInterval> intervals;
    for (std::size_t i = 0; i < prey.size(); ++i) {
        const auto count = [](int number) { return static_cast<std::uint32_t>(number); };
        GenerationStatistics island = of_species(count(prey[i]), count(prey[i]) / 2, prey[i], 7);
        if (predators[i] >= 0) {
            island.predators = {of_species(count(predators[i]), 0, predators[i], 1)};
        }
        intervals.push_back(
            species_of(std::vector{island}, intervals.empty() ? SpeciesOfInterval{} : intervals.back()));
    }
    return intervals;
}

TEST(Persistence, AddsTheIslands) {
    GenerationStatistics first = of_species(10, 8, 9.5, 3), second = of_species(20, 15, 17, 4);
    second.predators = {of_species(5, 2, 3, 1)};
    const SpeciesOfInterval species = species_of(std::vector{first, second}, {});
    EXPECT_EQ(species[0], (SpeciesInterval{true, 30, 23, 7, 26.5}));
    EXPECT_EQ(species[1], (SpeciesInterval{true, 5, 2, 1, 3}));
    EXPECT_EQ(species_of(std::vector{first}, species)[1], (SpeciesInterval{.has_come = true}));
    EXPECT_EQ(species_of(std::vector{GenerationStatistics{}}, {}), SpeciesOfInterval{});
}

TEST(Persistence, ExtinctionIsCensored) {
    const auto living = run_with({9, 9, 9}, {-1, 3, 3});
    EXPECT_EQ(intervals_lived(living), 3u);
    EXPECT_FALSE(persistence_of(living, 0)->extinct_in);
    EXPECT_EQ(persistence_of(living, 1)->arrived_in, 2u);
    EXPECT_FALSE(persistence_of(living, 1)->extinct_in);
    const auto extinct = run_with({9, 9, 9, 9}, {-1, 3, 0, -1});
    EXPECT_EQ(intervals_lived(extinct), 2u);
    EXPECT_EQ(persistence_of(extinct, 1)->extinct_in, 3u);
    EXPECT_FALSE(persistence_of(extinct, 0)->extinct_in);
    EXPECT_FALSE(persistence_of(run_with({9}, {-1}), 1));
    EXPECT_EQ(intervals_lived({}), 0u);
}

TEST(Persistence, MeansLeaveOutTheFirstIntervals) {
    std::vector<int> prey(20, 1000);
    for (int i = 0; i < 20; ++i) {
        prey.push_back(i % 2 == 0 ? 10 : 14);
    }
    const auto persistence = persistence_of(run_with(prey, std::vector<int>(40, -1)), 0);
    EXPECT_EQ(persistence->count_mean, 12);
    EXPECT_EQ(persistence->count_deviation, 2);
    EXPECT_EQ(persistence->lowest_count, 5u);
    EXPECT_EQ(persistence->born_mean, 7);
    EXPECT_EQ(persistence_of(run_with({4, 8}, {-1, -1}), 0)->count_mean, 8);
    EXPECT_EQ(persistence_of(run_with({4}, {-1}), 0)->count_mean, 4);
}

} // namespace
} // namespace evod::experiments
