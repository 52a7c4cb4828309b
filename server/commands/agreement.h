// Agreement: processes that mpirun has started check that all of them have read the same input.
//
// Threads  the main thread of each process.
#pragma once

#include "server/base/result.h"
#include "server/runtime/processes.h"

#include <string>

namespace evod::commands {

/// Compares what the processes have read. All processes must call it.
///
/// mine     everything that must be equal, as text, or the refusal of this process.
/// returns  in all processes the same: a refusal that names a process with a refusal, or with another text than rank 0.
///          A process that is alone gets its own refusal.
base::Result<void> agree(const base::Result<std::string>& mine, runtime::Processes& processes);

/// Whether `this_one` is true in any process. All processes must call it.
bool any(bool this_one, runtime::Processes& processes);

} // namespace evod::commands
