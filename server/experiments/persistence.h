// Persistence: how long the species of a world with births live, how many organisms they have, and how fast these are
// replaced.
//
// Threads      none.
// Determinism  a function of the statistics of the intervals.
#pragma once

#include "server/simulation/statistics.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace evod::experiments {

/// One species in one interval, on all islands.
struct SpeciesInterval {
    bool has_come = false; // whether the species is on the islands or has been there
    std::uint64_t alive_count = 0, lowest_count = 0, born_count = 0;
    double count_mean = 0;
    friend bool operator==(const SpeciesInterval&, const SpeciesInterval&) = default;
};
using SpeciesOfInterval = std::array<SpeciesInterval, 2>; // prey, predators

/// Returns the species of an interval.
///
/// islands  their statistics, in a world with births.
/// before   the result for the previous interval; in the first interval, a new object.
SpeciesOfInterval species_of(std::span<const simulation::GenerationStatistics> islands,
                             const SpeciesOfInterval& before);

/// How one species persisted. The mean numbers leave out the first settling_intervals after its arrival, or half of its
/// intervals if these are fewer than twice as many.
struct SpeciesPersistence {
    std::uint64_t arrived_in = 0;               // interval, from 1
    std::optional<std::uint64_t> extinct_in;    // the first interval at whose end none lives; nullopt: censored
    double count_mean = 0, count_deviation = 0; // living organisms, over time
    std::uint64_t lowest_count = 0;
    double born_mean = 0; // children per interval
};
constexpr std::size_t settling_intervals = 20;

/// Returns how a species persisted; nullopt if it never came.
///
/// intervals  of one run, in order.
/// species    0: prey, 1: predators.
std::optional<SpeciesPersistence> persistence_of(std::span<const SpeciesOfInterval> intervals, std::size_t species);

/// Returns the number of intervals at whose end every species that had come lived.
std::uint64_t intervals_lived(std::span<const SpeciesOfInterval> intervals);

} // namespace evod::experiments
