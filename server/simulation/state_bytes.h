// State bytes: the islands of a world's state as bytes, column by column. Run files store them, and the processes that
// share a world exchange them. The layout: docs/RUN_FILE.md.
//
// The bytes that are read may come from an untrusted file. The shapes of the islands at the beginning of the generation
// determine their number, so reading allocates no more memory than that. World::restore() checks the values.
#pragma once

#include "server/base/result.h"
#include "server/simulation/colony.h"
#include "server/simulation/world_state.h"

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace evod::simulation {

/// In a colony, the most organisms that are born on an island in an interval, and the most genes of latest births.
/// No state has more; a reader refuses it.
constexpr std::uint32_t born_max = 16'000'000, latest_genes_max = 16'000'000;

/// Writes state.islands, state.ratings and state.ended. The parameters decide whether they have the parts of colonies.
///
/// write  called with one piece after another.
void write_state(const WorldState& state, const std::function<void(std::string_view)>& write);
/// Returns how many bytes write_state() writes.
std::size_t bytes_of_state(const WorldState& state);

/// Reads what write_state() has written. Refused unless the bytes are a state of islands with these shapes.
base::Result<void> read_state(std::string_view bytes, std::span<const IslandShape> shapes, WorldState& state);
/// Refuses a number of bytes that no state of islands with these shapes has.
base::Result<void> check_state_size(std::size_t bytes, std::span<const IslandShape> shapes);

std::string bytes_of_opening(const IslandOpening& opening);
/// Reads what bytes_of_opening() has returned. Allocates no more memory than a few times the number of bytes.
base::Result<IslandOpening> read_opening(std::string_view bytes);

} // namespace evod::simulation
