// Display: whether there is a screen to draw on, and how fine it is. SFML aborts where there is none.
//
// The connection to the X server that is made to find out stays open until the program ends: a server may end, or begin
// anew, when its last client leaves.
//
// Threads      used by the one that draws.
#pragma once

#include <optional>

namespace evod::viewer {

/// Throws std::runtime_error, with what to do, if no window could be opened.
void check_display();

/// How much larger than at 96 dots per inch things have to be on this screen: the desktop's setting, or else what the
/// screen says of itself; 1 where neither is known. In quarters, within 0.5 and 4.
double display_scale();

struct Desktop {
    unsigned width, height; // in pixels
    bool managed;           // by a window manager, which puts windows where they belong
};
/// Nullopt where it is not known.
std::optional<Desktop> desktop();

} // namespace evod::viewer
