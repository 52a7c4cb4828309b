// Elementary functions for several numbers at once, for kernels (lanes.h). Each lane gives the same result as the
// function of the same name in elementary.h.
#pragma once

#include "server/base/approximations.h"
#include "server/base/lanes.h"
#include "server/base/random_lanes.h"

namespace evod::base {
namespace {

inline Floats absolute(Floats v) {
    return (Floats)((Words)v & 0x7fff'ffffu);
}

template <std::size_t count>
inline Floats polynomial(const float (&coefficients)[count], Floats x) {
    Floats sum = all_lanes(coefficients[count - 1]);
    for (std::size_t n = count - 1; n-- > 0;) {
        sum = sum * x + coefficients[n];
    }
    return sum;
}

inline Floats tanh(Floats x) {
    const Floats cut = lesser(greater(x, all_lanes(-tanh_range)), all_lanes(tanh_range));
    const Floats square = cut * cut;
    const Floats value = cut * polynomial(tanh_numerator, square) / polynomial(tanh_denominator, square);
    return lesser(greater(value, all_lanes(-1.0f)), all_lanes(1.0f));
}

inline Floats half_turns(Floats x, Floats y) {
    const Floats across = absolute(x), up = absolute(y);
    const Floats longer = greater(across, up);
    const Floats slope = lesser(across, up) / (longer == 0.0f ? all_lanes(1.0f) : longer);
    Floats angle = slope * polynomial(arc_tangent, slope * slope);
    angle = up > across ? 0.5f - angle : angle;
    angle = x < 0.0f ? 1.0f - angle : angle;
    return y < 0.0f ? -angle : angle;
}

/// Computes direction_of() for each lane.
inline Directions directions_of(Floats radians) {
    return directions((Words)round_to_integers(radians * words_per_radian / 2) * 2u);
}

} // namespace
} // namespace evod::base
