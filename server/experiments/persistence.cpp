#include "server/experiments/persistence.h"

#include <algorithm>
#include <cmath>

namespace evod::experiments {
namespace {

void add(const simulation::GenerationStatistics& island, SpeciesInterval& species) {
    species.has_come = true;
    species.alive_count += island.alive_count;
    species.lowest_count += island.colony->lowest_count;
    species.born_count += island.colony->born_count;
    species.count_mean += island.colony->count_mean;
}

bool died_out(const SpeciesInterval& species) {
    return species.has_come && species.alive_count == 0;
}

} // namespace

SpeciesOfInterval species_of(std::span<const simulation::GenerationStatistics> islands,
                             const SpeciesOfInterval& before) {
    SpeciesOfInterval species;
    for (std::size_t i = 0; i < species.size(); ++i) {
        species[i].has_come = before[i].has_come;
    }
    for (const simulation::GenerationStatistics& island : islands) {
        if (island.colony) {
            add(island, species[0]);
        }
        for (const simulation::GenerationStatistics& predators : island.predators) {
            if (predators.colony) {
                add(predators, species[1]);
            }
        }
    }
    return species;
}

std::optional<SpeciesPersistence> persistence_of(std::span<const SpeciesOfInterval> intervals, std::size_t species) {
    const auto come = std::ranges::find_if(intervals, [&](const auto& each) { return each[species].has_come; });
    const auto gone = std::find_if(come, intervals.end(), [&](const auto& each) { return died_out(each[species]); });
    if (come == intervals.end()) {
        return std::nullopt;
    }
    SpeciesPersistence persistence;
    persistence.arrived_in = static_cast<std::uint64_t>(come - intervals.begin()) + 1;
    if (gone != intervals.end()) {
        persistence.extinct_in = static_cast<std::uint64_t>(gone - intervals.begin()) + 1;
    }
    const auto end = gone == intervals.end() ? gone : gone + 1;
    const auto all = static_cast<std::size_t>(end - come), left_out = std::min(settling_intervals, all / 2);
    const auto counted = std::span{come, end}.subspan(left_out);
    const auto count = static_cast<double>(counted.size());
    persistence.lowest_count = counted.front()[species].lowest_count;
    double sum = 0, squares = 0, born = 0;
    for (const SpeciesOfInterval& interval : counted) {
        sum += interval[species].count_mean;
        born += static_cast<double>(interval[species].born_count);
        persistence.lowest_count = std::min(persistence.lowest_count, interval[species].lowest_count);
    }
    persistence.count_mean = sum / count;
    for (const SpeciesOfInterval& interval : counted) {
        const double difference = interval[species].count_mean - persistence.count_mean;
        squares += difference * difference;
    }
    persistence.count_deviation = std::sqrt(squares / count);
    persistence.born_mean = born / count;
    return persistence;
}

std::uint64_t intervals_lived(std::span<const SpeciesOfInterval> intervals) {
    const auto gone = std::ranges::find_if(
        intervals, [](const SpeciesOfInterval& each) { return std::ranges::any_of(each, died_out); });
    return static_cast<std::uint64_t>(gone - intervals.begin());
}

} // namespace evod::experiments
