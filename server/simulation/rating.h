// Rating: the fitness of organisms from clients, for worlds whose parameter `fitness` is external.
//
// After the last tick of a generation, the world awaits the fitness of every organism: one number, or as many as the
// parameter `objectives` says. With it, clients may send repaired chromosomes, which breed in place of those that the
// organisms were born with. A client sends the numbers of an island in one or several commands, in order of id; it may
// begin again with organism 0 while numbers are missing. When all islands are rated, the generation is over.
//
// Determinism  numbers and chromosomes come from the commands alone. They are part of the state hash until the next
//              generation.
#pragma once

#include "server/base/result.h"
#include "server/base/state_hash.h"
#include "server/simulation/commands.h"
#include "server/simulation/world.h"

#include <span>
#include <vector>

namespace evod::simulation {

/// Checks whether a world can get this fitness now. A refusal names the wrong field: "set_fitness.first_organism".
base::Result<void> check(const World& world, const SetFitness& command);

/// Returns the part of a world's state hash that covers what clients have given, per island.
base::StateHash hash_of(std::span<const Rating> ratings);

/// Returns whether a state whose islands have been checked has possible ratings.
///
/// awaited  whether the state is after the last tick of a generation whose fitness comes from clients.
bool can_be_given(const WorldState& state, bool awaited);
/// Returns whether no fitness is missing in a state that can_be_given() has accepted.
bool is_whole(const WorldState& state);

} // namespace evod::simulation
