// Screenshot: one picture of a world in a file, without a window.
#pragma once

#include "client/viewer/shell/options.h"

namespace evod::viewer {

/// Waits for the picture and saves it. Sends no command; if the world stands still before the tick, says so on the
/// error output and waits on. Throws std::runtime_error, with a sentence for a person, if the picture cannot be had.
void take_screenshot(const Options& options, const Options::Screenshot& screenshot);

} // namespace evod::viewer
