// Actor: formats the actor of a command or event for people.
#pragma once

#include "evod/v1/world.pb.h"

#include <string>

namespace evod::core {

/// "karl: evoctl 127.0.0.1:5000"; "evoctl 127.0.0.1:5000" for a client without a user. The server sends viewers the user only:
/// "karl", or "a local client" without a user. Also "the schedule", "a goal", "evod".
std::string to_text(const v1::Actor& actor);

} // namespace evod::core
