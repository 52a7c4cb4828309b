// Packed: parts of worlds and changes of worlds as bytes, for the processes that share a world (sharing.h).
//
// unpack_…() reads what pack() has written.
#pragma once

#include "server/base/packing.h"
#include "server/evolution/next_generation.h"
#include "server/parameters/schedule.h"
#include "server/simulation/commands.h"
#include "server/simulation/statistics.h"
#include "server/simulation/world_state.h"

#include <cstdint>
#include <span>
#include <vector>

namespace evod::simulation {

void pack(base::Packer& packer, const GenerationStatistics& statistics);
GenerationStatistics unpack_statistics(base::Unpacker& unpacker);

void pack(base::Packer& packer, const evolution::NextGeneration& generation);
evolution::NextGeneration unpack_generation(base::Unpacker& unpacker);

void pack(base::Packer& packer, const IslandState& state);
IslandState unpack_island_state(base::Unpacker& unpacker);

void pack(base::Packer& packer, const parameters::Schedule& schedule);
parameters::Schedule unpack_schedule(base::Unpacker& unpacker);

void pack(base::Packer& packer, const parameters::PlannedChange& change);
parameters::PlannedChange unpack_planned_change(base::Unpacker& unpacker);

// Commands without the names of their worlds.
void pack(base::Packer& packer, const PlaceEntities& command);
PlaceEntities unpack_place_entities(base::Unpacker& unpacker);

void pack(base::Packer& packer, const RemoveEntities& command);
RemoveEntities unpack_remove_entities(base::Unpacker& unpacker);

void pack(base::Packer& packer, const SetFitness& command);
SetFitness unpack_set_fitness(base::Unpacker& unpacker);

} // namespace evod::simulation
