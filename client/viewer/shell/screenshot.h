// Saves one frame of a world as a PNG file, without a window.
#pragma once

#include "client/viewer/shell/options.h"

namespace evod::viewer {

/// Waits for a snapshot of the wanted tick or a later one, draws it and saves the frame. Sends no command; if the world
/// is stopped before the tick, standard error says so, and the wait continues. Throws std::runtime_error, with one
/// sentence, on failure.
void take_screenshot(const Options& options, const Options::Screenshot& screenshot);

} // namespace evod::viewer
