// Theory: the numbers that the theory of selection predicts for one breeding, beside those observed.
//
// The law of each selection method is the server's (evolution/selection_law): it sends the expected copies of every
// rank. What follows from them is computed here. Ranks count from 0, the fittest; ties go to the lower id.
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

/// The law of the copies as the server sends it, by rank; each shape (population).
struct Expectation {
    std::vector<double> copies;          // in all picks
    std::vector<double> standard_error;  // standard deviation of the copies from one breeding to the next
    std::vector<double> unpicked_chance; // of no copy at all
};

/// The properties of a selection that decide which predictions exist.
struct Selection {
    enum class Method { Roulette, StochasticUniversal, Tournament, Random, Truncation };
    /// What the chance of an organism depends on.
    enum class Pressure { Fitness, WindowedFitness, Rank };

    Method method = Method::Roulette;
    Pressure pressure = Pressure::Fitness;
    bool independent_picks = true; // one pick does not change the chances of another
    bool overlapping = false;      // steady_state: most of the generation stays
    std::uint32_t picks = 1;
};

/// Reads them from the parameters of a breeding; missing parameters have their defaults.
Selection selection_of(const evod::v1::Breeding& breeding);

/// One predicted number.
struct Prediction {
    std::string_view name{}, sentence{}, source{};
    std::string_view unit{};                // empty: dimensionless
    std::optional<double> expected{};       // nullopt: never, or theory has no answer; the sentence says which
    std::optional<double> observed{};       // nullopt: one breeding does not show it
    std::optional<double> standard_error{}; // of the observed number; nullopt: unknown

    /// Standard errors between the observed and the expected number, with the sign of the difference; nullopt if one of
    /// the three is unknown. Infinite if the observed number is impossible.
    std::optional<double> deviation() const;
};

/// observed − expected in standard errors; 0 where both are the same to within rounding.
double deviation(double observed, double expected, double standard_error);

/// Copies of the fittest, selection intensity, share not selected, loss of diversity, takeover time, and how well all
/// copies together agree with the law.
///
/// fitness  best first, shape (population), finite.
/// copies   observed, by rank, shape (population); empty: unknown, then nothing is observed.
/// returns  empty if there are no picks.
std::vector<Prediction> predictions(const Selection& selection, const Expectation& expectation,
                                    std::span<const double> fitness, std::span<const std::uint32_t> copies);

// ---- the numbers, one by one -----------------------------------------------------------------------------------

/// (mean fitness of the picked − mean fitness) / standard deviation of the fitness; 0 where all are equal.
/// copies  by rank, expected or observed; not all 0.
double selection_intensity(std::span<const double> copies, std::span<const double> fitness);

/// The same for a normally distributed fitness, whatever the fitness is here. In large populations it tends to the
/// closed forms of Blickle & Thiele.
double normal_selection_intensity(std::span<const double> copies);

/// The share of the population that is replaced by copies of others: the sum of what the expected copies fall short of
/// one each, if as many are picked as there are organisms. Source: Blickle & Thiele 1996.
double loss_of_diversity(std::span<const double> copies);

/// Generations until copies of the fittest, one at first, fill all places but one, by selection alone, if the whole
/// generation is replaced and every number is the expected one. Source: Goldberg & Deb 1991.
///
/// copies   expected, by rank.
/// returns  nullopt: never; or theory has no answer: where a window or a negative fitness is subtracted again in each
///          generation, or where generations overlap.
std::optional<std::uint32_t> takeover_generations(const Selection& selection, std::span<const double> copies,
                                                  std::span<const double> fitness);

} // namespace evod::viewer
