// Worker pool: the Executor that the server passes to the core.
//
// Threads      up to `threads` threads work at the same time, including the caller. oneTBB schedules them. Under
//              ThreadSanitizer, jobs::ThreadPool replaces oneTBB (EVOD_THREAD_EXECUTOR).
// Determinism  the loop is divided into the pieces that Executor guarantees, whichever thread computes them.
#pragma once

#include "server/base/executor.h"

#include <cstddef>
#include <memory>

namespace evod::runtime {

/// threads  >= 1. With 1, every loop runs on the calling thread and no thread is started.
std::unique_ptr<base::Executor> make_executor(std::size_t threads);

} // namespace evod::runtime
