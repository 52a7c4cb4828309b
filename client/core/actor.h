// Who caused something, as people read it.
#pragma once

#include "evod/v1/world.pb.h"

#include <string>

namespace evod::core {

/// "karl: evoctl 127.0.0.1:5000", "evoctl 127.0.0.1:5000" of a client without a user, "karl" as viewers are told,
/// "a local client" as they are told of one without a user; "the schedule", "a goal", "evod".
std::string to_text(const v1::Actor& actor);

} // namespace evod::core
