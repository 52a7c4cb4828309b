// Worker pool: the executor that a server gives to the core.
//
// Threads      `threads` of them work at once, the one that starts a loop included. oneTBB does the scheduling; where
//              ThreadSanitizer has to see everything, tests/support's ThreadExecutor does (EVOD_THREAD_EXECUTOR).
// Determinism  the pieces are those that Executor promises, whoever runs them.
#pragma once

#include "server/base/executor.h"

#include <cstddef>
#include <memory>

namespace evod::runtime {

/// threads  >= 1; 1 runs every loop on its caller and starts nothing.
std::unique_ptr<base::Executor> make_executor(std::size_t threads);

} // namespace evod::runtime
