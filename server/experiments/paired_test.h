// Paired test: do two worlds that were run with the same seeds differ by more than chance, and by how much?
//
// Threads      none.
// Determinism  what is drawn is keyed by the seed that is given; sums are taken in order.
#pragma once

#include "server/base/random.h"

#include <optional>
#include <span>
#include <vector>

namespace evod::experiments {

struct Interval {
    double low = 0, high = 0;
    bool contains(double value) const { return low <= value && value <= high; }
};

double mean_of(std::span<const double> sample);
/// Of a sample: divided by n − 1, n >= 2.
double deviation_of(std::span<const double> sample);

/// Where the mean of what was sampled lies, with so much confidence: Student's interval, n >= 2.
Interval student_interval(std::span<const double> sample, double confidence = 0.95);

/// Hedges' g of paired differences: Cohen's d_z, their mean over their deviation, times 1 − 3/(4(n − 1) − 1), without
/// which small samples overstate it.
///
/// returns  nothing for fewer than three differences, and where all are equal, for then there is no deviation to
///          measure by.
/// Source   Lakens 2013, "Calculating and reporting effect sizes to facilitate cumulative science", Frontiers in
///          Psychology 4:863, doi:10.3389/fpsyg.2013.00863; Hedges 1981.
std::optional<double> hedges_g(std::span<const double> differences);

/// So many differences have every pattern of signs looked at; of more, as many patterns are drawn as these have, less
/// one.
constexpr std::size_t exact_sign_flips_max = 20;

/// The two-sided p-value of the sign-flip permutation test: how large a share of all patterns of signs gives a sum at
/// least as far from 0 as the one found. If the two worlds do not differ, each difference might as well have had the
/// other sign.
///
/// differences  n >= 1; of more than exact_sign_flips_max the patterns are drawn, the one found counted among them.
/// Source       Fisher 1935, "The Design of Experiments", 21; for drawn ones Phipson & Smyth 2010, "Permutation
///              P-values should never be zero", doi:10.2202/1544-6115.1585.
double sign_flip_p(std::span<const double> differences, base::Seed seed);

/// The smallest p-value that sign_flip_p can come to with so many differences.
double least_sign_flip_p(std::size_t differences);

/// The p-values of several tests, adjusted so that the chance of even one false alarm among them stays what one test's
/// is. Shape and order of `p`.
///
/// Source  Holm 1979, "A simple sequentially rejective multiple test procedure".
std::vector<double> holm(std::span<const double> p);

} // namespace evod::experiments
