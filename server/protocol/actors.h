// Actors: converts the cause of a change from a text to the message Actor.
//
// The simulation and run files store the cause as text: "user: client address", "client address" for a client without a
// token, and "evod" for the server itself.
#pragma once

#include "evod/v1/world.pb.h"

#include <string_view>

namespace evod::protocol {

constexpr std::string_view by_the_server = "evod";

/// Parses the text of a cause: "user: client address", "client address" or "evod".
v1::Actor actor_of(std::string_view by);
v1::Actor actor_of_kind(v1::ActorKind kind);

/// Removes client and address from every Actor in the message, at any depth. Viewers must not see which programs and
/// addresses other clients use.
void keep_users_only(google::protobuf::Message& message);

} // namespace evod::protocol
