// Display: whether there is a display to draw on, and its resolution. SFML aborts without a display.
//
// The connection to the X server stays open until the program ends: an X server may exit or reset when its last client
// disconnects.
//
// Threads      used by the thread that draws.
#pragma once

#include <optional>

namespace evod::viewer {

/// Throws std::runtime_error, which says what to do, if no window can be opened.
void check_display();

/// The scale of text and widgets for this display, relative to 96 dots per inch: from the desktop's setting, else from
/// the size that the display reports; 1 if neither is known. A multiple of 1/4, from 0.5 to 4.
double display_scale();

struct Desktop {
    unsigned width, height; // in pixels
    bool managed;           // by a window manager, which places windows
};
/// Nullopt without a connection to the X server.
std::optional<Desktop> desktop();

} // namespace evod::viewer
