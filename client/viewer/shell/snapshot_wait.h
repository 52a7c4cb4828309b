// Snapshot wait: waits for the snapshots of panes that are drawn without a window, and writes the progress messages.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/panes/pane.h"

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

/// Processes everything that was received since the last call. Returns whether every pane has received an answer to all
/// its requests and a snapshot of each island that it shows.
bool all_have_snapshots(Panes& panes);

} // namespace evod::viewer
