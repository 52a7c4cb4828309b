// Past changes: which parameters of a stored run changed up to a moment, in which generation, and by whom. A world that
// starts in the middle of its run gets them from here; a world that has simulated its whole run has recorded the same.
//
// Threads      none of its own.
#pragma once

#include "server/replay/rerun.h"
#include "server/run_file/run_file.h"
#include "server/simulation/changes.h"

#include <cstdint>
#include <span>

namespace evod::replay {

/// Returns the changes of a run up to `moment`. For a fork, these are the changes since the fork.
///
/// changes      all changes in the file's journal, as world_changes() returns them.
/// after_entry  the last journal entry that was applied before `moment`.
simulation::Changes past_changes(run_file::RunFile& file, std::span<const WorldChange> changes,
                                 std::uint64_t after_entry, const simulation::Moment& moment);

} // namespace evod::replay
