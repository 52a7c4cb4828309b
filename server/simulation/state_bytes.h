// State bytes: the islands of a world's state as bytes, column by column. Run files store them, and the processes that
// share a world exchange them. The layout: docs/RUN_FILE.md.
//
// The bytes that are read may come from an untrusted file. The shapes of the islands at the beginning of the generation
// determine their number, so reading allocates no more memory than that. World::restore() checks the values.
#pragma once

#include "server/base/result.h"
#include "server/simulation/world_state.h"

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>

namespace evod::simulation {

/// Writes state.islands, state.ratings and state.ended.
///
/// write  called with one piece after another.
void write_state(const WorldState& state, const std::function<void(std::string_view)>& write);
/// Returns how many bytes write_state() writes.
std::size_t bytes_of_state(const WorldState& state);

/// Reads what write_state() has written. Refused unless the bytes are a state of islands with these shapes.
base::Result<void> read_state(std::string_view bytes, std::span<const IslandShape> shapes, WorldState& state);
/// Refuses a number of bytes that no state of islands with these shapes has.
base::Result<void> check_state_size(std::size_t bytes, std::span<const IslandShape> shapes);

} // namespace evod::simulation
