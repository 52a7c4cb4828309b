// Checkpoint: the bytes of a world's state (simulation/state_bytes.h), compressed by zstd.
//
// The bytes that are read come from an untrusted file. Decoding allocates no more memory than a state of the islands
// can need. How many organisms are born in an interval is not known before, so in a colony the number of compressed
// bytes limits the memory, too.
#pragma once

#include "server/base/result.h"
#include "server/run_file/records.h"
#include "server/simulation/world_state.h"

#include <span>
#include <string>
#include <string_view>

namespace evod::run_file {

/// Encodes and compresses the state of the islands.
std::string pack(const simulation::WorldState& state);

/// Converts a checkpoint to the form that a run file stores.
StoredCheckpoint pack(const Checkpoint& checkpoint);

/// Encodes and compresses what begins an interval of an island, and the reverse.
std::string pack(const simulation::IslandOpening& opening);
base::Result<simulation::IslandOpening> unpack_opening(std::string_view packed);

/// Decodes the state of the islands. Refused unless `packed` is a compressed state of islands with these shapes.
base::Result<void> unpack(std::string_view packed, std::span<const simulation::IslandShape> shapes,
                          simulation::WorldState& state);

} // namespace evod::run_file
