// Actors: who caused something, as a message.
//
// The simulation and run files keep it as text: "user: client address", "client address" of a client without a token,
// "evod" of the server itself.
#pragma once

#include "evod/v1/world.pb.h"

#include <string_view>

namespace evod::protocol {

constexpr std::string_view by_the_server = "evod";

/// by  in that form.
v1::Actor actor_of(std::string_view by);
v1::Actor actor_of_kind(v1::ActorKind kind);

/// Removes client and address from each Actor in the message and in the messages within: viewers are not told other
/// clients' programs and addresses.
void keep_users_only(google::protobuf::Message& message);

} // namespace evod::protocol
