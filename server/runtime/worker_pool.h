// Worker pool: the executor that the server gives to the core.
//
// Threads      up to `threads` work at once, including the calling thread. oneTBB schedules them; under ThreadSanitizer
//              the ThreadExecutor of tests/support does (EVOD_THREAD_EXECUTOR).
// Determinism  the pieces are those that Executor promises, whichever thread computes them.
#pragma once

#include "server/base/executor.h"

#include <cstddef>
#include <memory>

namespace evod::runtime {

/// threads  >= 1; with 1 every loop runs on its caller and no thread starts.
std::unique_ptr<base::Executor> make_executor(std::size_t threads);

} // namespace evod::runtime
