// Entities: items and organisms that commands place on an island or remove from it, between two ticks.
//
// A placed item exists until it is eaten or removed, or until the generation ends. It does not reappear. A placed
// organism joins the generation with the next id, at rest and with the full health of its genes. Its fitness counts the
// seconds since it was placed, and it breeds like the others. A removed item does not reappear in the generation. A
// removed organism is dead; its fitness is the seconds that it lived.
//
// Determinism  the result depends on the commands and their ticks alone.
#pragma once

#include "server/base/result.h"
#include "server/parameters/model_parameters.h"
#include "server/simulation/commands.h"
#include "server/simulation/world.h"

namespace evod::simulation {

/// Checks whether a world can place the entities now. A refusal lists every wrong field (at most faults_max) as the
/// sender spells it: "place.items[2].x_px".
base::Result<void> check(const World& world, const PlaceEntities& command);
/// Checks whether a world can remove the entities now; "remove.food[0]".
base::Result<void> check(const World& world, const RemoveEntities& command);

} // namespace evod::simulation
