// Event texts: the notices that the window shows for events of a world.
//
// Threads      none; pure functions.
#pragma once

#include "evod/v1/session.pb.h"

#include <string>

namespace evod::viewer {

/// Returns the notice for an event, one sentence without a full stop: "evoctl 127.0.0.1 changed mutation_chance",
/// "evoctl 127.0.0.1 placed 3 food on island 2". Empty for events that have no notice.
///
/// several_islands  whether the world has more than one island, so that the notice must name it
std::string event_text(const evod::v1::Event& event, bool several_islands = false);

} // namespace evod::viewer
