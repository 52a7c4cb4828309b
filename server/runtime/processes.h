// Processes: the processes that `mpirun` has started together to share the islands of one world, or the runs of a
// sweep.
//
// MPI is used only by the component evod_mpi, a shared library in the folder of the program. It is loaded when a
// launcher of MPI has started the program; otherwise evod neither needs nor loads it.
//
// Threads      only the thread that joined uses the exchange.
#pragma once

#include "server/base/exchange.h"
#include "server/base/result.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

namespace evod::runtime {

class Processes : public base::Exchange {
  public:
    /// Returns the number of processes of this job on this machine.
    virtual std::uint32_t on_this_machine() const = 0;
    /// Returns a rank and its machine, as users know them: "rank 2 on node7".
    virtual std::string name_of(std::uint32_t rank) const = 0;
    /// Returns for how long this process has waited for the others and for what they send, in seconds. May be called on
    /// any thread.
    virtual double exchange_s() const = 0;
};

/// Whether a launcher of MPI has started this process as one of several.
bool is_one_of_several();

/// Joins the other processes of this job; they leave it when the object is destroyed. A process outside a job is alone.
///
/// patience        time for which a process waits for the others. If one of them does not arrive in time, rank 0 names
///                 it on stderr, and all processes end with the status exit_rank_lost.
/// first_may_rest  whether the others wait for a broadcast() of rank 0 without limit.
/// returns         a refusal if a launcher has started the process, but evod_mpi is missing or is that of another
///                 version.
base::Result<std::unique_ptr<Processes>> join_processes(std::chrono::seconds patience, bool first_may_rest = false);

constexpr int exit_rank_lost = 5;

} // namespace evod::runtime
