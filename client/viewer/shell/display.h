// Display: checks whether there is a display to draw on, and finds its resolution. SFML aborts if there is no display.
//
// The connection to the X server stays open until the program ends, because an X server may exit or reset when its last
// client disconnects.
//
// Threads      used by the thread that draws.
#pragma once

#include <optional>

namespace evod::viewer {

/// Throws std::runtime_error if no window can be opened. The message explains what to do.
void check_display();

/// Returns the scale of text and widgets for this display, relative to 96 dots per inch. It follows the desktop's
/// setting or, without one, the size that the display reports; 1 if neither is known. The scale is a multiple of 1/4,
/// from 0.5 to 4.
double display_scale();

struct Desktop {
    unsigned width, height; // in pixels
    bool managed;           // a window manager is running, which places windows
};
/// Returns the desktop's properties; nullopt without a connection to the X server.
std::optional<Desktop> desktop();

} // namespace evod::viewer
