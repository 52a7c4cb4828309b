// Checkpoint: the islands of a world's state as bytes, columns compressed by zstd. The layout: docs/RUN_FILE.md.
//
// The bytes come from outside when they are read: how many there must be follows from what the islands hold at their
// generation's beginning, so no more memory is taken than that, and what they say is judged by World::restore.
#pragma once

#include "server/base/result.h"
#include "server/run_file/records.h"
#include "server/simulation/world_state.h"

#include <span>
#include <string>
#include <string_view>

namespace evod::run_file {

/// state.islands and state.ended, compressed.
std::string pack(const simulation::WorldState& state);

/// As a run file holds it.
StoredCheckpoint pack(const Checkpoint& checkpoint);

/// Fills in state.islands and state.ended. Refused unless the bytes are a packed state of such islands.
base::Result<void> unpack(std::string_view packed, std::span<const simulation::IslandShape> shapes,
                          simulation::WorldState& state);

/// The same from bytes that are not compressed.
base::Result<void> read_columns(std::string_view bytes, std::span<const simulation::IslandShape> shapes,
                                simulation::WorldState& state);

} // namespace evod::run_file
