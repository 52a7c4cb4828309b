// Fork of a run file (`evod fork`): creates a run that begins with a moment of another run, with the same seed,
// organisms and parameters. So every later difference between the two runs is caused by a command (common random
// numbers).
//
// How the server forks a live world or a replay is in runtime/fork.h.
#pragma once

#include "server/run_file/run_file.h"

namespace evod::replay {

/// Creates the file `path` for a run that begins with the first moment of a generation of `origin`. Without a
/// generation, it begins with the last moment of `origin`. The file does not depend on any other file. It contains no
/// commands, so the world waits for a command to run.
///
/// returns  the moment with which the run begins. Refused if `path` exists, if the origin does not contain the
///          generation, if it is damaged there, or if it follows another model.
base::Result<simulation::Moment> fork(run_file::RunFile& origin, std::optional<std::uint64_t> generation,
                                      const std::string& path, const std::string& name, const simulation::RunId& run_id,
                                      base::Executor& executor);

} // namespace evod::replay
