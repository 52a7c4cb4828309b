// Paired test: tests whether paired differences are larger than chance explains, and estimates how large they are.
//
// Threads      none.
// Determinism  random draws depend only on the given seed; sums are computed in index order.
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
/// The sample standard deviation, with divisor n − 1. n >= 2.
double deviation_of(std::span<const double> sample);

/// The confidence interval of the mean from Student's t distribution. n >= 2.
Interval student_interval(std::span<const double> sample, double confidence = 0.95);

/// Hedges' g of paired differences: Cohen's d_z (mean divided by standard deviation) times 1 − 3/(4(n − 1) − 1). The
/// factor corrects the bias of small samples.
///
/// returns  nullopt for fewer than three differences. Also nullopt if all differences are equal, because their standard
///          deviation is 0.
/// Source   Lakens 2013, "Calculating and reporting effect sizes to facilitate cumulative science", Frontiers in
///          Psychology 4:863, doi:10.3389/fpsyg.2013.00863; Hedges 1981.
std::optional<double> hedges_g(std::span<const double> differences);

/// For up to this number of differences n, the test uses all 2^n sign patterns. For more, it draws 2^20 − 1 patterns.
constexpr std::size_t exact_sign_flips_max = 20;

/// The two-sided p-value of the sign-flip permutation test: the share of sign patterns whose sum is at least as far
/// from 0 as the observed sum. If the two worlds do not differ, each difference is equally likely to have the opposite
/// sign.
///
/// differences  n >= 1. If n exceeds exact_sign_flips_max, the observed pattern counts as one of the drawn patterns.
/// Source       Fisher 1935, "The Design of Experiments", 21; for drawn patterns Phipson & Smyth 2010, "Permutation
///              P-values should never be zero", doi:10.2202/1544-6115.1585.
double sign_flip_p(std::span<const double> differences, base::Seed seed);

/// The smallest p-value that sign_flip_p() can return for this number of differences.
double least_sign_flip_p(std::size_t differences);

/// Adjusts the p-values of several tests, so that the family-wise error rate is that of one test. The result has the
/// shape and order of `p`.
///
/// Source  Holm 1979, "A simple sequentially rejective multiple test procedure".
std::vector<double> holm(std::span<const double> p);

} // namespace evod::experiments
