// Elementary functions that return the same bits on every processor: sin, cos, exp, log, pow, tanh and the angle of a
// vector, computed with + − × ÷ and rounding only. elementary_lanes.h has some of them for kernels.
//
// On processors with fused multiply-add, the C library runs different code, whose last bits differ. Code that affects
// the state of a world must therefore not call the C library's functions. √ is an exception: every processor rounds it
// correctly.
// Source  Taylor series after the usual range reductions (Muller 2016, Elementary Functions, ch. 11).
#pragma once

namespace evod::base {

constexpr double pi = 3.14159265358979323846;

/// sin(2π · turns) and cos(2π · turns) for |turns| <= 2^40. The absolute error is below 1e-15.
double sin_turns(double turns);
double cos_turns(double turns);

/// Returns e^x. The relative error is below 1e-15 for |x| <= 700. The result is 0 for x < −700, and the largest double
/// for x > 700.
double exp(double x);

/// Returns the natural logarithm of a normal x > 0. The relative error (near x = 1, the absolute error) is below 1e-15.
double log(double x);

/// Returns x^y for x > 0: exp(y log x). The relative error is below 1e-15 · (1 + |y log x|). 0^y is 0 for y > 0, and
/// 0^0 is 1.
double pow(double x, double y);

/// A vector of length 1 to within 3e-7.
struct Direction {
    float x, y;
};

/// Returns the direction at the angle `word`/2^32 of a full turn, from +x toward +y. It is uniform if `word` is
/// uniform.
Direction direction(unsigned word);

/// Returns the direction at an angle of |radians| <= 4, from +x toward +y, to within 5e-7 of the exact one.
Direction direction_of(float radians);

/// Returns the hyperbolic tangent, −1 … 1. The relative error is below 3e-7. The result for −x is minus that for x.
float tanh(float x);

/// Returns the angle of the vector (x, y) from +x toward +y in half turns: atan2(y, x) / π, −1 … 1. The relative error
/// is below 3e-7. The angle of (0, 0) is 0. |x| and |y| must be 0 or normal.
float half_turns(float x, float y);

} // namespace evod::base
