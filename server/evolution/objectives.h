// Several objectives: which organisms of a population are better than which, if each is rated with several numbers.
//
// Determinism  fronts, distances and standing depend on the numbers and the indices of the organisms alone.
// Cost         O(n log n) for two objectives; for more, up to O(n²) comparisons if few organisms dominate others.
// Source       Deb, Pratap, Agarwal & Meyarivan 2002, "A fast and elitist multiobjective genetic algorithm: NSGA-II",
//              doi:10.1109/4235.996017; the order of comparisons in fronts() is that of Zhang et al. 2015,
//              doi:10.1109/TEVC.2014.2308305.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace evod::evolution {

/// The objectives of a population: `count` numbers for each organism, one organism after another; finite, larger is
/// better.
struct Objectives {
    std::span<const double> numbers;
    std::size_t count; // at least 1

    std::size_t organisms() const { return numbers.size() / count; }
    std::span<const double> of(std::uint32_t organism) const { return numbers.subspan(organism * count, count); }
};

/// Returns the fronts of a population, the best first: no organism of a front is dominated by one of the same or a
/// later front, and each is dominated by one of the front before. An organism dominates another if it is worse in no
/// objective and better in at least one. Within a front, organisms with a larger first objective come first.
std::vector<std::vector<std::uint32_t>> fronts(const Objectives& objectives);

/// Returns the crowding distance of each organism of a front: the sum over all objectives of the distance between its
/// two neighbours, divided by the width of the front. The first and the last organism in any objective have an
/// infinite distance.
std::vector<double> crowding_distances(const Objectives& objectives, std::span<const std::uint32_t> front);

/// Returns the standing of each organism: minus the number of organisms that are better. An organism is better than
/// another if its front is, or if both are in the same front and its crowding distance is larger.
std::vector<double> standing(const Objectives& objectives);

} // namespace evod::evolution
