// Recovery: restores a world at the last moment in its run file.
//
// A server recovers every world of its data folder when it starts (archive.h). A fork of the end of a run uses recovery
// too. Recovery simulates the run from its last checkpoint, so it belongs to replay and not to recording. Replay may
// include recording and pass the recovered worlds to it; recording needs no simulation.
//
// Threads      none of its own.
// Determinism  the restored world has the same bits as the original one. All stored state hashes after the start are
//              compared.
#pragma once

#include "server/base/executor.h"
#include "server/run_file/run_file.h"

#include <vector>

namespace evod::replay {

struct Recovered {
    simulation::World world;
    simulation::RunControl control;
    std::vector<run_file::JournalEntry> journal;
};

/// Reads the journal once and simulates the run from its last checkpoint to its last tick. Refused for the same reasons
/// as Rerun::at(), and if a state hash differs from the stored one.
base::Result<Recovered> recover(run_file::RunFile& file, base::Executor& executor);

/// Reads back the file of a run that has just begun, and restores the world with which it begins, as recover() does.
/// Refused if this fails, or if the state hash is not `hash`.
base::Result<void> check_beginning(run_file::RunFile& file, const base::StateHash& hash, base::Executor& executor);

/// Extends the reason why a world cannot be restored from its file by what can be done about it. Clients, the log and
/// `evod verify` show this sentence.
base::Refusal with_remedies(base::Refusal why);
/// Returns the damaged world that a world becomes if its run file cannot be restored or written for this reason.
///
/// run_id  nullopt: unknown.
simulation::DamagedWorld damaged_world(std::string name, const std::optional<simulation::RunId>& run_id,
                                       const base::Refusal& why);

} // namespace evod::replay
