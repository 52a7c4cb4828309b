// Records worlds frame by frame into files, without a window.
#pragma once

#include "client/viewer/shell/options.h"

namespace evod::viewer {

/// Records until the wanted ticks or generations are recorded, the run ends, or SIGINT or SIGTERM arrives.
///
/// Worlds that this session may command are stepped from frame to frame, so that no tick is missed. Their lease is
/// released at the end, and worlds that ran before run again. Of other worlds the snapshots are drawn as they arrive, and
/// standard error reports how many ticks were missed. Throws std::runtime_error, with one sentence, on failure.
void record(const Options& options, const Options::Record& wanted);

} // namespace evod::viewer
