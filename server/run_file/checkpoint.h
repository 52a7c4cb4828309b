// Checkpoint: encodes the islands of a world's state as columns, compressed by zstd. The layout: docs/RUN_FILE.md.
//
// Bytes that are read come from an untrusted file. Their number follows from the shapes of the islands at the beginning
// of the generation, so decoding allocates no more than that. World::restore() checks the values.
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

/// The form that a run file stores.
StoredCheckpoint pack(const Checkpoint& checkpoint);

/// Fills in state.islands and state.ended. Refused unless the bytes are a compressed state of such islands.
base::Result<void> unpack(std::string_view packed, std::span<const simulation::IslandShape> shapes,
                          simulation::WorldState& state);

/// The same from uncompressed bytes.
base::Result<void> read_columns(std::string_view bytes, std::span<const simulation::IslandShape> shapes,
                                simulation::WorldState& state);

} // namespace evod::run_file
