// Fork: how the server carries out ForkWorld, the fork of a live world or of a replay. `evod fork`, the fork of a run
// file, is in replay/run_file_fork.h.
//
// World     as it is now: a copy, made on the thread of the original (Laboratory::construction, ReplayLoop::fork). At
//           an earlier generation: the loop of the replays seeks there in the stored run (ComputeForkWorld in mail.h).
// Run       CommandHandler::fork begins and ends a fork; its run begins with the world that world_of_fork() returns.
// Check     check_fork() reads the file of the fork back, as a restart would, before the client gets its answer.
// Threads   the simulation threads call the first two functions, a background job of the dispatcher check_fork().
#pragma once

#include "server/runtime/job_turns.h"
#include "server/runtime/replies.h"
#include "server/simulation/commands.h"
#include "server/simulation/world.h"

namespace evod::runtime {

/// Whether the fork begins with another generation than the one in which the original is. Its world must then be
/// computed from the stored run.
bool begins_in_another_generation(const simulation::ForkWorld& command, const simulation::World& original);

/// Returns the world with which the run of the fork begins: at the first moment of the generation if the command names
/// one, otherwise at the moment of `world`.
///
/// world  in the generation with which the fork begins.
simulation::World world_of_fork(const simulation::ForkWorld& command, simulation::World world,
                                base::Executor& executor);

/// Reads done.fork back. Returns the answer to the client: a refusal if the file does not restore the world.
///
/// turn  of the job. It is given back between two attempts.
CommandDone check_fork(CommandDone done, JobTurns::Turn& turn);

} // namespace evod::runtime
