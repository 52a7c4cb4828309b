// Event texts: the notices that the window shows for events of a world.
//
// Threads      none; pure functions.
#pragma once

#include "evod/v1/session.pb.h"

#include <string>

namespace evod::viewer {

/// Returns the notice for an event, one sentence without a full stop: "evoctl 127.0.0.1 changed mutation_chance". Empty
/// for events that have no notice.
std::string event_text(const evod::v1::Event& event);

} // namespace evod::viewer
