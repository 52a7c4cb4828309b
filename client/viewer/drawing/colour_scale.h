// Colour scale: numbers → colours of a ramp, and the bar that tells which.
//
// Threads      none; bars by the thread that draws.
#pragma once

#include "client/viewer/drawing/palette.h"

struct ImDrawList;
struct ImVec2;

namespace evod::viewer {

/// The ends of the ramp are `low` and `high`, and what is beyond them has their colour.
struct ColourScale {
    palette::Ramp ramp = palette::Ramp::Viridis;
    double low = 0, high = 1;

    /// Where low = high everything is in the middle.
    double share(double value) const { return high > low ? (value - low) / (high - low) : 0.5; }
    Colour operator()(double value) const { return palette::at(ramp, share(value)); }
};

/// All colours of a ramp, from its least at the left.
void draw_ramp(ImDrawList& list, ImVec2 corner, ImVec2 size, palette::Ramp ramp);

} // namespace evod::viewer
