// Fork: creates a run that begins within another one, with the same seed, organisms and parameters. So every later
// difference between the two runs is caused by a command (common random numbers).
#pragma once

#include "server/run_file/run_file.h"

namespace evod::replay {

/// Creates the file `path` for a run that begins with the first moment of a generation of `origin`, or with its last
/// moment. The file needs no other one. It contains no commands, so the world waits to be run.
///
/// returns  that moment. Refused if `path` exists, or if the origin has no such generation, is damaged there or follows
///          another model.
base::Result<simulation::Moment> fork(run_file::RunFile& origin, std::optional<std::uint64_t> generation,
                                      const std::string& path, const std::string& name, const simulation::RunId& run_id,
                                      base::Executor& executor);

} // namespace evod::replay
