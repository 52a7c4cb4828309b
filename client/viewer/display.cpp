#include "client/viewer/display.h"

#include <X11/Xlib.h>

#include <cstdlib>
#include <stdexcept>
#include <string>

namespace evod::viewer {

void check_display() {
    const char* name = std::getenv("DISPLAY");
    if (Display* display = XOpenDisplay(nullptr)) {
        XCloseDisplay(display);
        return;
    }
    const std::string why =
        name == nullptr || *name == '\0' ? "DISPLAY is not set" : "\"" + std::string{name} + "\" cannot be opened";
    throw std::runtime_error{"no display: " + why + "; without a screen, use xvfb-run evoview …"};
}

} // namespace evod::viewer
