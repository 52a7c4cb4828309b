// Shared worlds: the processes that mpirun has started share the worlds of `evod run` and of the server. Rank 0 runs
// the command: it alone reads and writes files, prints, and serves clients. The others simulate islands for it.
//
// Threads  the main thread of each process.
#pragma once

#include "server/runtime/processes.h"
#include "server/simulation/islands.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace evod::command_line {
class Command;
}

namespace evod::commands {

struct SharingOptions {
    std::optional<std::size_t> threads; // nullopt: the processors of a machine are divided among its processes
    std::uint32_t rank_timeout_s = 60;
};
/// Adds --threads and --rank-timeout.
void add_sharing_options(command_line::Command& command, SharingOptions& options);

/// What rank 0 works with. A process that mpirun has not started is rank 0 of one.
struct SharedWork {
    runtime::Processes& processes;
    simulation::IslandsMaker* maker; // divides the islands of worlds among the processes; nullptr if there is only one
    std::size_t threads;             // of this process
};

/// Joins the other processes. On rank 0 calls work(), on the others simulates islands for it until it returns. There,
/// signals are ignored, because rank 0 ends the command cleanly.
///
/// command         must be the same in all processes: what was started, as text.
/// first_may_rest  whether rank 0 may have nothing to do. If not, the others end when they wait for it too long.
/// returns         the exit status: on rank 0 that of work(). exit_error if the processes cannot work together; then
///                 rank 0 has printed why.
int share_worlds(const std::string& command, const SharingOptions& options, bool first_may_rest,
                 const std::function<int(const SharedWork&)>& work);

} // namespace evod::commands
