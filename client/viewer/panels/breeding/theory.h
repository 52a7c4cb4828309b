// Theory: the numbers that the theory of selection predicts for one breeding, beside the observed numbers.
//
// The server computes the expected copies of every rank from the law of the selection method (evolution/selection_law)
// and sends them. The predictions here are derived from the expected copies. Ranks count from 0, the fittest; among
// equal fitness values the lower id ranks first.
//
// Owner        Comparison.
// Threads      none.
// Source       Blickle & Thiele 1996, "A comparison of selection schemes used in evolutionary algorithms", Evol.
//              Comput. 4(4); Goldberg & Deb 1991, "A comparative analysis of selection schemes used in genetic
//              algorithms"; Baker 1987, "Reducing bias and inefficiency in the selection algorithm"; Motoki 2002,
//              "Calculating the expected loss of diversity of selection schemes", Evol. Comput. 10(4).
#pragma once

#include "evod/v1/commands.pb.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace evod::viewer {

/// The distribution of the copies as sent by the server. Each list is indexed by rank and has shape (population).
struct Expectation {
    std::vector<double> copies;          // expected copies, in all picks together
    std::vector<double> standard_error;  // standard deviation of the copies over repetitions of the breeding
    std::vector<double> unpicked_chance; // probability of having no copy
};

/// The properties of a selection that decide which predictions are possible.
struct Selection {
    enum class Method { Roulette, StochasticUniversal, Tournament, Random, Truncation };
    /// The quantity that decides the chance of an organism.
    enum class Pressure { Fitness, WindowedFitness, Rank };

    Method method = Method::Roulette;
    Pressure pressure = Pressure::Fitness;
    bool independent_picks = true; // a pick does not change the chances in other picks
    bool overlapping = false;      // steady_state: most organisms survive into the next generation
    std::uint32_t picks = 1;
};

/// Reads the properties from the parameters of a breeding. A missing parameter has its default value.
Selection selection_of(const evod::v1::Breeding& breeding);

/// A number that theory predicts, with the observed number.
struct Prediction {
    std::string_view name{}, sentence{}, source{};
    std::string_view unit{};                // empty: dimensionless
    std::optional<double> expected{};       // nullopt: never, or no theory predicts it; see `sentence`
    std::optional<double> observed{};       // nullopt: cannot be observed in one breeding
    std::optional<double> standard_error{}; // standard error of the observed number; nullopt: unknown

    /// Returns (observed − expected) / standard error. Returns nullopt if one of these three numbers is unknown.
    /// Infinite if theory rules out the observed number.
    std::optional<double> deviation() const;
};

/// Returns (observed − expected) / standard_error; 0 if both numbers differ only by rounding.
double deviation(double observed, double expected, double standard_error);

/// Predicts the copies of the fittest, selection intensity, the share not selected, loss of diversity, takeover time,
/// and how well all copies together agree with the law.
///
/// fitness  fitness values, best first, shape (population), finite.
/// copies   observed copies by rank, shape (population); empty: unknown, and no prediction contains an observed number.
/// returns  an empty list if there are no picks.
std::vector<Prediction> predictions(const Selection& selection, const Expectation& expectation,
                                    std::span<const double> fitness, std::span<const std::uint32_t> copies);

// ---- the numbers, one by one -----------------------------------------------------------------------------------

/// Returns (mean fitness of the picked − mean fitness of all) / standard deviation of the fitness; 0 if all fitness
/// values are equal.
/// copies  expected or observed copies by rank; not all 0.
double selection_intensity(std::span<const double> copies, std::span<const double> fitness);

/// Returns the selection intensity that these copies would have if the fitness were normally distributed. In large
/// populations it tends to the closed forms of Blickle & Thiele.
double normal_selection_intensity(std::span<const double> copies);

/// Returns the share of the population that copies of other organisms replace. It is Σ max(0, 1 − expected copies) /
/// population, with the copies scaled to as many picks as there are organisms. Source: Blickle & Thiele 1996.
double loss_of_diversity(std::span<const double> copies);

/// Returns the number of generations until copies of the fittest occupy all places but one. Assumes one copy at the
/// start, selection alone, replacement of the whole generation, and that every number of copies equals its expectation.
/// Source: Goldberg & Deb 1991.
///
/// copies   expected copies by rank.
/// returns  nullopt if the takeover never happens or theory gives no value. Theory gives none if generations overlap,
///          or if a window or a negative fitness is subtracted again in each generation.
std::optional<std::uint32_t> takeover_generations(const Selection& selection, std::span<const double> copies,
                                                  std::span<const double> fitness);

} // namespace evod::viewer
