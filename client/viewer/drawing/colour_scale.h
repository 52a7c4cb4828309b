// Colour scale: maps numbers to colours of a ramp, and draws the ramp as a bar.
//
// Owner        none: a value.
// Threads      none; bars are drawn on the drawing thread.
#pragma once

#include "client/viewer/drawing/palette.h"

struct ImDrawList;
struct ImVec2;

namespace evod::viewer {

/// `low` and `high` have the colours of the ends of the ramp, and so have all numbers beyond them.
struct ColourScale {
    palette::Ramp ramp = palette::Ramp::Viridis;
    double low = 0, high = 1;

    /// 0.5 for every value if low = high.
    double share(double value) const { return high > low ? (value - low) / (high - low) : 0.5; }
    Colour operator()(double value) const { return palette::at(ramp, share(value)); }
};

/// Draws all colours of a ramp from left (lowest) to right.
void draw_ramp(ImDrawList& list, ImVec2 corner, ImVec2 size, palette::Ramp ramp);

} // namespace evod::viewer
