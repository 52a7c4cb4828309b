// Record: picture after picture of worlds, in files, without a window.
#pragma once

#include "client/viewer/shell/options.h"

namespace evod::viewer {

/// Records until what was asked for is recorded, the run is over, or SIGINT or SIGTERM ends it. Worlds that may be
/// commanded are stepped from picture to picture, so that none is missed, and given back at the end: one that ran is
/// only lent and goes on. Of others pictures are taken as they come, and how many ticks were not shown is told on the
/// error output. Throws std::runtime_error, with a sentence for a person, if that cannot be done.
void record(const Options& options, const Options::Record& wanted);

} // namespace evod::viewer
