// The notices that events of a world give to the person at the window.
//
// Threads      none; pure functions.
#pragma once

#include "evod/v1/session.pb.h"

#include <string>

namespace evod::viewer {

/// One sentence without a full stop: "evoctl 127.0.0.1 changed mutation_chance"; empty for events without a notice.
std::string event_text(const evod::v1::Event& event);

} // namespace evod::viewer
