#include "server/base/elementary.h"

#include "server/base/approximations.h"
#include "server/base/assert.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace evod::base {
namespace {

constexpr double ln2 = 0.69314718055994530942;

constexpr std::array<double, 24> inverse_factorials() {
    std::array<double, 24> values{};
    double factorial = 1;
    values[0] = 1;
    for (int n = 1; n < 24; ++n) {
        factorial *= n;
        values[static_cast<unsigned>(n)] = 1 / factorial;
    }
    return values;
}
constexpr auto inverse_factorial = inverse_factorials();

/// Returns the Taylor series of sine (if `last` is odd) or cosine (if `last` is even) up to the power `last`, for |x|
/// <= π/4. If `last` is 18 or 19, the first omitted term is below 1e-19.
template <class Real>
constexpr Real series(Real x, int last) {
    const Real square = x * x;
    Real sum = 0;
    for (int n = last; n >= 0; n -= 2) {
        const Real coefficient = static_cast<Real>(inverse_factorial[static_cast<unsigned>(n)]);
        sum = sum * square + (n % 4 < 2 ? coefficient : -coefficient);
    }
    return last % 2 == 1 ? sum * x : sum;
}

struct Octant {
    unsigned quarter; // index of the nearest multiple of a quarter turn, mod 4
    double angle;     // the remainder, in −π/4 … π/4
};

Octant reduce(double turns) {
    const double fraction = turns - std::floor(turns);
    const double quarters = std::floor(fraction * 4 + 0.5);
    return {static_cast<unsigned>(quarters) % 4, (fraction - quarters / 4) * (2 * pi)};
}

} // namespace

double cos_turns(double turns) {
    const Octant o = reduce(turns);
    switch (o.quarter) {
    case 0:
        return series(o.angle, 18);
    case 1:
        return -series(o.angle, 19);
    case 2:
        return -series(o.angle, 18);
    default:
        return series(o.angle, 19);
    }
}

double sin_turns(double turns) {
    const Octant o = reduce(turns);
    switch (o.quarter) {
    case 0:
        return series(o.angle, 19);
    case 1:
        return series(o.angle, 18);
    case 2:
        return -series(o.angle, 19);
    default:
        return -series(o.angle, 18);
    }
}

double exp(double x) {
    if (x < -700) {
        return 0;
    }
    if (x > 700) {
        return std::numeric_limits<double>::max();
    }
    // ln 2 in two parts, the first with 21 trailing zero bits, so that k · ln2_high is exact.
    constexpr double ln2_high = 0x1.62e42feep-1;
    constexpr double ln2_low = 0x1.a39ef35793c76p-33;
    const double k = std::floor(x / ln2 + 0.5);
    const double r = (x - k * ln2_high) - k * ln2_low;
    double sum = 0;
    for (int n = 14; n >= 0; --n) {
        sum = sum * r + inverse_factorial[static_cast<unsigned>(n)];
    }
    const auto exponent = static_cast<std::uint64_t>(static_cast<std::int64_t>(k) + 1023);
    return sum * std::bit_cast<double>(exponent << 52);
}

double log(double x) {
    EVOD_ASSERT(x >= std::numeric_limits<double>::min());
    const auto bits = std::bit_cast<std::uint64_t>(x);
    auto exponent = static_cast<double>(static_cast<std::int64_t>(bits >> 52) - 1023);
    double mantissa = std::bit_cast<double>((bits & 0x000f'ffff'ffff'ffff) | 0x3ff0'0000'0000'0000);
    if (mantissa > 1.41421356237309504880) {
        mantissa /= 2;
        exponent += 1;
    }
    // log m = 2 artanh s with s = (m − 1)/(m + 1), |s| <= 0.172.
    const double s = (mantissa - 1) / (mantissa + 1);
    const double square = s * s;
    double sum = 0;
    for (int n = 23; n >= 1; n -= 2) {
        sum = sum * square + 1.0 / n;
    }
    return exponent * ln2 + 2 * s * sum;
}

double pow(double x, double y) {
    if (x == 0) {
        return y == 0 ? 1 : 0;
    }
    return exp(y * log(x));
}

Direction direction(unsigned word) {
    // The angle is split into the nearest quarter turn and a signed remainder: at most an eighth of a turn, with 29
    // bits.
    const unsigned quarter = (word + 0x2000'0000u) >> 30;
    const auto rest = static_cast<std::int32_t>(word - (quarter << 30));
    const float angle = static_cast<float>(rest) * static_cast<float>(2 * pi / 4294967296.0);
    const float s = series(angle, 9), c = series(angle, 8);
    switch (quarter & 3) {
    case 0:
        return {c, s};
    case 1:
        return {-s, c};
    case 2:
        return {-c, -s};
    default:
        return {s, -c};
    }
}

namespace {

template <std::size_t count>
float polynomial(const float (&coefficients)[count], float x) {
    float sum = coefficients[count - 1];
    for (std::size_t n = count - 1; n-- > 0;) {
        sum = sum * x + coefficients[n];
    }
    return sum;
}

} // namespace

Direction direction_of(float radians) {
    EVOD_ASSERT(std::abs(radians) <= 4);
    return direction(static_cast<unsigned>(std::lrint(radians * words_per_radian / 2)) * 2u);
}

float tanh(float x) {
    const float cut = std::clamp(x, -tanh_range, tanh_range);
    const float square = cut * cut;
    return std::clamp(cut * polynomial(tanh_numerator, square) / polynomial(tanh_denominator, square), -1.0f, 1.0f);
}

float half_turns(float x, float y) {
    const float across = std::abs(x), up = std::abs(y);
    const float longer = std::max(across, up);
    const float slope = std::min(across, up) / (longer == 0 ? 1 : longer);
    float angle = slope * polynomial(arc_tangent, slope * slope);
    angle = up > across ? 0.5f - angle : angle;
    angle = x < 0 ? 1 - angle : angle;
    return y < 0 ? -angle : angle;
}

} // namespace evod::base
