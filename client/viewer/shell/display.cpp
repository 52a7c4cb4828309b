#include "client/viewer/shell/display.h"

#include <X11/Xlib.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace evod::viewer {

namespace {

/// Returns the connection to the X server. Null if there is no X server or it accepts no more clients.
Display* connection() {
    static Display* const opened = XOpenDisplay(nullptr); // never closed; see display.h
    return opened;
}

} // namespace

void check_display() {
    const char* name = std::getenv("DISPLAY");
    if (connection() != nullptr) {
        return;
    }
    const std::string why =
        name == nullptr || *name == '\0' ? "DISPLAY is not set" : "\"" + std::string{name} + "\" cannot be opened";
    throw std::runtime_error{"no display: " + why + "; without a screen, use xvfb-run evoview …"};
}

double display_scale() {
    Display* display = connection();
    if (display == nullptr) {
        return 1;
    }
    double dots_per_inch = 0;
    if (const char* set = XGetDefault(display, "Xft", "dpi")) { // from the desktop's settings
        dots_per_inch = std::atof(set);
    } else if (const int screen = DefaultScreen(display); DisplayWidthMM(display, screen) > 0) {
        dots_per_inch = DisplayWidth(display, screen) * 25.4 / DisplayWidthMM(display, screen);
    }
    return dots_per_inch > 0 ? std::clamp(std::round(dots_per_inch / 96 * 4) / 4, 0.5, 4.0) : 1;
}

std::optional<Desktop> desktop() {
    Display* display = connection();
    if (display == nullptr) {
        return std::nullopt;
    }
    const int screen = DefaultScreen(display);
    // Only a window manager selects SubstructureRedirect on the root window, so this flag shows whether one is running.
    XWindowAttributes root{};
    const bool known = XGetWindowAttributes(display, RootWindow(display, screen), &root) != 0;
    return Desktop{.width = static_cast<unsigned>(DisplayWidth(display, screen)),
                   .height = static_cast<unsigned>(DisplayHeight(display, screen)),
                   .managed = known && (root.all_event_masks & SubstructureRedirectMask) != 0};
}

} // namespace evod::viewer
