// Coefficients of the approximations in elementary.h and elementary_lanes.h, from the constant term upward.
//
// Source  Minimax approximations of the relative error, found by iteratively reweighted least squares (Lawson 1961; for
//         the quotient Sanathanan & Koerner 1963).
#pragma once

namespace evod::base {

/// tanh(x) = x · numerator(x²) / denominator(x²) for |x| <= tanh_range, with a relative error of 2.1e-8.
/// Beyond it, the result is that for tanh_range.
constexpr float tanh_range = 9;
constexpr float tanh_numerator[] = {0.9999999794754441f, 0.13381014813375416f, 0.0034955752500742494f,
                                    2.060887231297879e-05f, 1.3354379087142013e-08f};
constexpr float tanh_denominator[] = {1.0f, 0.46714330412416016f, 0.025876933229231607f, 0.00032856138062489564f,
                                      7.776440653955726e-07f};

/// atan(x) / π = x · arc_tangent(x²) for |x| <= 1, with a relative error of 1.6e-8.
constexpr float arc_tangent[] = {0.3183098813383787f,    -0.10610246800969345f,  0.06363848661297566f,
                                 -0.045211620828536914f, 0.03387119945677191f,   -0.02388701465152393f,
                                 0.01358924404394346f,   -0.005114867217924868f, 0.0009071630643973094f};

/// The words of direction() per radian.
constexpr float words_per_radian = static_cast<float>(4294967296.0 / (2 * 3.14159265358979323846));

} // namespace evod::base
