// Elementary functions that give the same bits on every processor: sin, cos, exp, log and pow from + − × ÷ and rounding
// alone.
//
// On processors with fused multiply-add the C library runs different code, which gives different last bits. Nothing
// that feeds the state may therefore call it. √ is exact in hardware and is used directly.
// Source  Taylor series after the usual range reductions (Muller 2016, Elementary Functions, ch. 11).
#pragma once

namespace evod::base {

constexpr double pi = 3.14159265358979323846;

/// sin(2π turns) and cos(2π turns); |turns| <= 2^40. Absolute error below 1e-15 of the exact function of `turns`.
double sin_turns(double turns);
double cos_turns(double turns);

/// e^x. Relative error below 1e-15 for |x| <= 700; 0 below −700, the largest double above 700.
double exp(double x);

/// Natural logarithm of x > 0 (normal). Error below 1e-15 relative, or absolute near 1.
double log(double x);

/// x^y for x > 0: exp(y log x), relative error below 1e-15 · (1 + |y log x|). 0^y is 0 for y > 0, and 0^0 is 1.
double pow(double x, double y);

/// A vector of length 1 to within 3e-7.
struct Direction {
    float x, y;
};

/// The direction at `word`/2^32 of a full turn from +x toward +y: uniform when the word is.
Direction direction(unsigned word);

} // namespace evod::base
