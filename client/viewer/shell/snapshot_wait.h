// Snapshot wait: waits for the snapshots of a world that is drawn without a window, and writes the progress messages.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/view/world_view.h"

#include <chrono>
#include <string>

namespace evod::viewer {

/// Interval between two checks for new snapshots.
constexpr std::chrono::milliseconds poll_interval{2};

/// Returns why no snapshot has arrived yet, for a timeout message: "the world "default" is paused at tick 12".
std::string progress_text(const ViewedWorld& world);

/// Returns the world's name in quotes: "the world "default"".
std::string quoted(const std::string& world);

/// Throws std::runtime_error, with one sentence, if no snapshot can ever arrive.
void check_reachable(const ViewedWorld& world);

/// Processes everything that was received since the last call. Returns whether every request has been answered and a
/// snapshot of each shown island has arrived.
bool has_all_snapshots(WorldView& view);

} // namespace evod::viewer
