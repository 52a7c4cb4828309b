// Shared worlds: lets the threads of one process play the processes that share worlds.
#pragma once

#include "server/jobs/thread_pool.h"
#include "server/simulation/shared/leader.h"
#include "tests/support/threaded_exchange.h"

#include <cstddef>
#include <cstdint>
#include <functional>

namespace evod::support {

/// Calls work(leader, executor) as rank 0 of so many processes. The others follow it.
///
/// threads  of each process.
inline void share_worlds(std::uint32_t processes, std::size_t threads,
                         const std::function<void(simulation::shared::Leader&, base::Executor&)>& work) {
    ThreadedExchange{processes}.run([&](base::Exchange& exchange) {
        jobs::ThreadPool executor{threads};
        if (exchange.rank() == 0) {
            simulation::shared::lead(exchange, [&](simulation::shared::Leader& leader) { work(leader, executor); });
        } else {
            simulation::shared::follow(exchange, executor);
        }
    });
}

} // namespace evod::support
