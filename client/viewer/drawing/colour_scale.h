// Colour scale: assigns colours of a ramp to numbers, and draws the ramp as a bar.
//
// Owner        none: a value.
// Threads      none; bars are drawn on the drawing thread.
#pragma once

#include "client/viewer/drawing/palette.h"

struct ImDrawList;
struct ImVec2;

namespace evod::viewer {

/// Maps `low` to one end of the ramp and `high` to the other. Numbers outside this range have the colour of the nearer
/// end.
struct ColourScale {
    palette::Ramp ramp = palette::Ramp::Viridis;
    double low = 0, high = 1;

    /// Returns the position of a value between `low` (0) and `high` (1), not clamped. Returns 0.5 for every value if
    /// low >= high.
    double share(double value) const { return high > low ? (value - low) / (high - low) : 0.5; }
    Colour operator()(double value) const { return palette::at(ramp, share(value)); }
};

/// Draws the ramp as a bar, with its lowest colour at the left and its highest at the right.
void draw_ramp(ImDrawList& list, ImVec2 corner, ImVec2 size, palette::Ramp ramp);

} // namespace evod::viewer
