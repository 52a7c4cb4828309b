// Fork: a run that begins within another one: the same seed, organisms and parameters, so that whatever then becomes
// different follows from what is changed there (common random numbers).
#pragma once

#include "server/run_file/run_file.h"

namespace evod::replay {

/// Makes the file `path` for a run that begins with the first moment of a generation of `origin`, or with the last
/// moment that this tells of. It needs no other file: it holds none of the commands of its origin, and waits to be told
/// to run.
///
/// returns  that moment. Refused where there is a file already, and where the origin has no such generation, is damaged
///          there or follows another model.
base::Result<simulation::Moment> fork(run_file::RunFile& origin, std::optional<std::uint64_t> generation,
                                      const std::string& path, const std::string& name, const simulation::RunId& run_id,
                                      base::Executor& executor);

} // namespace evod::replay
