// Waiting: for the pictures of panes that are drawn without a window: whether they can still come, and how things
// stand.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/stage/pane.h"

#include <chrono>
#include <string>

namespace evod::viewer {

/// Between two looks at what has come.
constexpr std::chrono::milliseconds look_again{2};

/// Where things stand, for the message of a time-out: "the world "default" is paused at tick 12".
std::string standing(const Watch& watch);

/// "the world "default"".
std::string quoted(const std::string& world);

/// Throws std::runtime_error, with a sentence for a person, if no picture will ever come.
void check_hope(const Watch& watch);

/// Takes in what has come. Whether every pane has a picture of every island it shows, and an answer to all it asked.
bool all_have_pictures(Panes& panes);

} // namespace evod::viewer
