// Fork check: reads the file of a new fork back, as a restart would, before the client gets its answer.
//
// Threads      a background job of the dispatcher calls it when the file is on the disk.
#pragma once

#include "server/runtime/job_turns.h"
#include "server/runtime/replies.h"

namespace evod::runtime {

/// Reads done.fork back. Returns the answer to the client: a refusal if the file does not restore the world.
///
/// turn  of the job. It is given back between two attempts.
CommandDone check_fork(CommandDone done, JobTurns::Turn& turn);

} // namespace evod::runtime
