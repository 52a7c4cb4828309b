// Theory: what the laws of selection say of one choice of parents, to be held against what happened.
//
// Ranks are counted from the fittest, 0, as the server counts them; of equals the lower id is the fitter.
//
// Threads      none.
// Sources      Blickle & Thiele 1996, "A comparison of selection schemes used in evolutionary algorithms", Evol.
//              Comput. 4(4); Goldberg & Deb 1991, "A comparative analysis of selection schemes used in genetic
//              algorithms"; Baker 1987, "Reducing bias and inefficiency in the selection algorithm"; Motoki 2002,
//              "Calculating the expected loss of diversity of selection schemes", Evol. Comput. 10(4).
#pragma once

#include "client/viewer/panels/breeding/expectation.h"

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace evod::viewer {

/// One number that theory foretells.
struct Finding {
    std::string_view name{}, sentence{}, source{};
    std::string_view unit{};                // empty: a number without one
    std::optional<double> expected{};       // nullopt: never, or the theory does not tell; the sentence says which
    std::optional<double> happened{};       // nullopt: it cannot be seen in one breeding
    std::optional<double> standard_error{}; // of what happens; nullopt: nobody knows it

    /// How many standard errors lie between what happened and what was expected, with the sign of the difference;
    /// nullopt if one of the three is not known. Infinite if something happened that cannot.
    std::optional<double> deviation() const;
};

/// happened − expected in standard errors; 0 where both are the same to within rounding.
double deviation(double happened, double expected, double standard_error);

/// Copies of the fittest, selection intensity, share not selected, loss of diversity, takeover time, and how well all
/// copies together agree.
///
/// copies   by rank, as counted, shape (population); empty: not known, then nothing has happened.
std::vector<Finding> findings(const Selection& selection, std::span<const double> fitness,
                              std::span<const std::uint32_t> copies);

// ---- the numbers, one by one -----------------------------------------------------------------------------------

/// How far the selected are above the others: (their mean fitness − the mean fitness) / the deviation of the fitness.
/// 0 where all are alike.
/// copies  by rank, expected or counted; not all 0.
double selection_intensity(std::span<const double> copies, std::span<const double> fitness);

/// The same for a fitness that is spread as a normal distribution, whatever it is here: what the closed forms of
/// Blickle & Thiele tell, which this tends to in large populations.
double normal_selection_intensity(std::span<const double> copies);

/// The share of the population whose place others get: that by which the expected copies fall short of one each, were
/// as many picked as there are. Source: Blickle & Thiele 1996.
double loss_of_diversity(std::span<const double> copies);

/// Generations until the fittest, one at first, has all places but one by selection alone, if everyone is replaced and
/// things happen as expected. Source: Goldberg & Deb 1991.
/// returns  nullopt: never; or the theory does not tell, as where a window or a negative fitness is taken off anew in
///          each generation, or where generations overlap.
std::optional<std::uint32_t> takeover_generations(const Selection& selection, std::span<const double> fitness);

} // namespace evod::viewer
