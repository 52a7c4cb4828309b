// Share: the islands of a world that this process simulates. The other islands of the world are simulated by other
// processes, with which World exchanges results (base/exchange.h).
//
// Every process has neighbouring islands, because neighbours of a ring exchange migrants.
#pragma once

#include "server/base/exchange.h"
#include "server/base/executor.h"
#include "server/base/packing.h"
#include "server/base/state_hash.h"
#include "server/evolution/next_generation.h"
#include "server/simulation/statistics.h"

#include <cstddef>
#include <cstdint>

namespace evod::simulation {

/// Returns the islands of one process: [0, island_count) is divided into `size` ranges whose lengths differ by at most
/// 1. Requires size <= island_count.
base::Range share_of(std::size_t island_count, std::uint32_t rank, std::uint32_t size);

/// Returns the rank of the process that simulates an island; the inverse of share_of().
std::uint32_t rank_of(std::size_t island_count, std::size_t island, std::uint32_t size);

/// What the other processes of a world know about an island.
struct IslandSummary {
    base::StateHash hash;
    std::uint32_t alive_count = 0, organism_count = 0;
};

void pack(base::Packer& packer, const GenerationStatistics& statistics);
GenerationStatistics unpack_statistics(base::Unpacker& unpacker);

void pack(base::Packer& packer, const evolution::NextGeneration& generation);
evolution::NextGeneration unpack_generation(base::Unpacker& unpacker);

} // namespace evod::simulation
