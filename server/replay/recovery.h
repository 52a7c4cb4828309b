// Recovery: restores a world at the last moment that its run file contains.
//
// A server calls it at start for every world of its data folder (archive.h); a fork of a run's end calls it too.
// Recovery simulates the run from its last checkpoint, so it is part of replay, not of recording: replay may include
// recording and hand the recovered worlds to it, and recording needs no simulation.
//
// Threads      none of its own.
// Determinism  the restored world has the bits of the original one; every stored state hash on the way is compared.
#pragma once

#include "server/base/executor.h"
#include "server/run_file/run_file.h"

#include <vector>

namespace evod::replay {

struct Recovered {
    simulation::World world;
    simulation::RunControl control;
    std::vector<run_file::JournalEntry> journal;
};

/// Reads the journal once and simulates the run from its last checkpoint to its last tick. Refused where Rerun::at is,
/// and where a state hash differs from the stored one.
base::Result<Recovered> recover(run_file::RunFile& file, base::Executor& executor);

} // namespace evod::replay
