// Screenshot: saves one frame of a world as a PNG file, without a window.
#pragma once

#include "client/viewer/shell/options.h"

namespace evod::viewer {

/// Waits for a snapshot of the requested tick or a later one, draws it and saves the frame. Sends no command. If the
/// world stops before the requested tick, prints this on standard error and continues to wait. Throws
/// std::runtime_error on failure, with one sentence.
void take_screenshot(const Options& options, const Options::Screenshot& screenshot);

} // namespace evod::viewer
