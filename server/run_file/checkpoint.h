// Checkpoint: encodes the islands of a world's state as columns, compressed by zstd. The layout: docs/RUN_FILE.md.
//
// The bytes that are read come from an untrusted file. The shapes of the islands at the beginning of the generation
// determine the size of the uncompressed state, so decoding allocates no more memory than that. World::restore() checks
// the values.
#pragma once

#include "server/base/result.h"
#include "server/run_file/records.h"
#include "server/simulation/world_state.h"

#include <span>
#include <string>
#include <string_view>

namespace evod::run_file {

/// Encodes state.islands and state.ended as columns and compresses them.
std::string pack(const simulation::WorldState& state);

/// Converts a checkpoint to the form that a run file stores.
StoredCheckpoint pack(const Checkpoint& checkpoint);

/// Decodes state.islands and state.ended. Refused unless `packed` is a compressed state of islands with these shapes.
base::Result<void> unpack(std::string_view packed, std::span<const simulation::IslandShape> shapes,
                          simulation::WorldState& state);

/// Like unpack(), but reads uncompressed bytes.
base::Result<void> read_columns(std::string_view bytes, std::span<const simulation::IslandShape> shapes,
                                simulation::WorldState& state);

} // namespace evod::run_file
