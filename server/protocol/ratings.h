// Ratings: converts the request SetFitness into a command, and the fitness that a world awaits into messages.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/base/result.h"
#include "server/simulation/commands.h"
#include "server/simulation/world.h"

#include <vector>

namespace evod::protocol {

/// Converts a request, and adds a violation for every field that is wrong in every world. simulation::check() checks
/// everything that depends on the state of the world.
simulation::SetFitness command_of(const v1::SetFitness& request, std::vector<base::Violation>& violations);

/// Adds to `islands` the islands of a world that are not rated completely. Adds none if the world awaits no fitness.
void add_awaited_islands(const simulation::World& world, google::protobuf::RepeatedField<std::uint32_t>& islands);

} // namespace evod::protocol
