// Paired test: whether paired differences are larger than chance explains, and how large they are.
//
// Threads      none.
// Determinism  random draws depend on the given seed; sums are taken in index order.
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
/// The standard deviation of a sample: with divisor n − 1, n >= 2.
double deviation_of(std::span<const double> sample);

/// The confidence interval of the mean by Student's t, n >= 2.
Interval student_interval(std::span<const double> sample, double confidence = 0.95);

/// Hedges' g of paired differences: Cohen's d_z (mean over standard deviation) times 1 − 3/(4(n − 1) − 1), which
/// corrects the bias of small samples.
///
/// returns  nullopt for fewer than three differences, and if all are equal, because their deviation is 0.
/// Source   Lakens 2013, "Calculating and reporting effect sizes to facilitate cumulative science", Frontiers in
///          Psychology 4:863, doi:10.3389/fpsyg.2013.00863; Hedges 1981.
std::optional<double> hedges_g(std::span<const double> differences);

/// The test of at most so many differences tries all 2^n patterns of signs. The test of more draws 2^20 − 1 patterns.
constexpr std::size_t exact_sign_flips_max = 20;

/// The two-sided p-value of the sign-flip permutation test: the share of all patterns of signs whose sum is at least as
/// far from 0 as the observed sum. If the two worlds do not differ, each difference is as likely with the other sign.
///
/// differences  n >= 1; for more than exact_sign_flips_max the observed pattern counts as one of the drawn.
/// Source       Fisher 1935, "The Design of Experiments", 21; for drawn ones Phipson & Smyth 2010, "Permutation
///              P-values should never be zero", doi:10.2202/1544-6115.1585.
double sign_flip_p(std::span<const double> differences, base::Seed seed);

/// The smallest p-value that sign_flip_p() can return for this number of differences.
double least_sign_flip_p(std::size_t differences);

/// The p-values of several tests, adjusted so that the family-wise error rate is that of one test. Shape and order of
/// `p`.
///
/// Source  Holm 1979, "A simple sequentially rejective multiple test procedure".
std::vector<double> holm(std::span<const double> p);

} // namespace evod::experiments
