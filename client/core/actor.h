// Actor: formats the actor of a command or event for people.
#pragma once

#include "evod/v1/world.pb.h"

#include <string>

namespace evod::core {

/// Returns "karl: evoctl 127.0.0.1:5000" for a client with a user, and "evoctl 127.0.0.1:5000" for a client without
/// one. The server sends only the user to clients with the role viewer: there the text is "karl", or "a local client"
/// if there is no user. Other actors are "the schedule", "a goal" and "evod".
std::string to_text(const v1::Actor& actor);

} // namespace evod::core
