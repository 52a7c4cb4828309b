// The checks of a Hello that depend on nothing else.
#pragma once

#include "evod/v1/session.pb.h"
#include "server/base/result.h"

#include <optional>
#include <string>

namespace evod::protocol {

/// Why the server cannot serve this client: invalid fields, or no common protocol version; nullopt: it can.
std::optional<base::Refusal> refusal_of(const v1::Hello& hello);

/// The client's name for logs and actors, never empty. It contains no ": ", which ends the user's name in an actor.
std::string client_name_of(const v1::Hello& hello);

} // namespace evod::protocol
