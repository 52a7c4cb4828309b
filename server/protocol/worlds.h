// Worlds: converts worlds, statistics and organisms into messages.
#pragma once

#include "evod/v1/commands.pb.h"
#include "evod/v1/world.pb.h"
#include "server/simulation/laboratory.h"

namespace evod::protocol {

v1::RunState to_proto(simulation::RunState state);
v1::Outcome to_proto(evolution::Outcome outcome);
v1::Speed to_proto(const simulation::Speed& speed);
v1::Storage to_proto(const simulation::Storage& storage);
v1::WorldInfo to_proto(const simulation::Entry& entry);
v1::DamagedWorld to_proto(const simulation::DamagedWorld& world);
v1::GenerationStatistics to_proto(const simulation::GenerationStatistics& statistics);
v1::LiveStatistics to_proto(const simulation::LiveStatistics& statistics, std::uint32_t island);

/// The parents as OrganismInfo.parents defines them; Island::no_parents if there are none.
evolution::Parents shown_parents(const simulation::Island& island, std::uint32_t id);

/// Returns the data of one organism. `id` must be below the number of organisms born on the island.
v1::OrganismInfo organism_info(const simulation::World& world, const simulation::Island& island, std::uint32_t id);

} // namespace evod::protocol
