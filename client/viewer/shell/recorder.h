// Recorder: records worlds frame by frame into files, without a window.
#pragma once

#include "client/viewer/shell/options.h"

namespace evod::viewer {

/// Records until the requested ticks or generations are recorded, the run ends, or SIGINT or SIGTERM arrives.
///
/// If this session may command a world, the world is stepped from frame to frame, so that no tick is missed. At the
/// end, its lease is released, and the world resumes if it was running before. For any other world, the snapshots are
/// drawn as they arrive, and the number of missed ticks is printed on standard error. Throws std::runtime_error on
/// failure, with one sentence.
void record(const Options& options, const Options::Record& wanted);

} // namespace evod::viewer
