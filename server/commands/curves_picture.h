// Curves picture: several curves over a common axis, each with a band, as a file of Scalable Vector Graphics.
//
// Threads      none.
// Determinism  the same numbers give the same bytes.
// Source       colours: Okabe & Ito 2008, "Color Universal Design": those that everybody can tell apart.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace evod::commands {

struct CurvePoint {
    double x = 0;
    double y = 0, low = 0, high = 0; // finite, low <= high
};

struct Curve {
    std::string name;               // ASCII; the legend shows the first 21 characters
    std::vector<CurvePoint> points; // at least one, x rising
};

struct CurvesText {
    std::string title, subtitle, x_label, y_label;
};

/// curves  at least one; the first is drawn above the others, and thicker.
std::string curves_picture(const CurvesText& text, std::span<const Curve> curves);

/// Round numbers from at least `least` to at most `greatest`, at most `count_max` of them (>= 2), rising; just `least`
/// if the two are equal.
std::vector<double> axis_ticks(double least, double greatest, std::size_t count_max);

} // namespace evod::commands
