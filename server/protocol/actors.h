// Actors: converts the cause of a change to the message Actor.
#pragma once

#include "evod/v1/world.pb.h"
#include "server/base/actor.h"

namespace evod::protocol {

v1::Actor to_proto(const base::Actor& actor);
v1::Actor actor_of_kind(v1::ActorKind kind);

/// Removes client and address from every Actor in the message, at any depth. Viewers must not see which programs and
/// addresses other clients use.
void keep_users_only(google::protobuf::Message& message);

} // namespace evod::protocol
