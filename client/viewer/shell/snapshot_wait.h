// Waiting for the snapshots of panes that are drawn without a window, and the texts that report its progress.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/panes/pane.h"

#include <chrono>
#include <string>

namespace evod::viewer {

/// How often to check for new snapshots.
constexpr std::chrono::milliseconds poll_interval{2};

/// The state of the connection or the world, for the message of a timeout: "the world "default" is paused at tick 12".
std::string progress_text(const ViewedWorld& world);

/// "the world "default"".
std::string quoted(const std::string& world);

/// Throws std::runtime_error, with one sentence, if no snapshot will ever arrive.
void check_reachable(const ViewedWorld& world);

/// Takes in what has arrived. Returns whether every pane has a snapshot of each island it shows, and all its answers.
bool all_have_snapshots(Panes& panes);

} // namespace evod::viewer
