// Entities: converts the requests Place and Remove into commands, and the ids of entities into messages.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/base/result.h"
#include "server/simulation/commands.h"

#include <vector>

namespace evod::protocol {

/// Converts a request, and adds a violation for every field that is wrong in every world. simulation::check() checks
/// everything that depends on the state of the world.
simulation::PlaceEntities command_of(const v1::Place& request, std::vector<base::Violation>& violations);
simulation::RemoveEntities command_of(const v1::Remove& request, std::vector<base::Violation>& violations);

/// The message Placed or Removed, without its field `by`.
v1::Placed placed_message(const simulation::EntityIds& ids);
v1::Removed removed_message(const simulation::EntityIds& ids);

} // namespace evod::protocol
