// Share: the islands of a world that one of several processes simulates.
//
// Every process has neighbouring islands, because neighbours of a ring exchange migrants.
#pragma once

#include "server/base/assert.h"
#include "server/base/executor.h"

#include <cstddef>
#include <cstdint>

namespace evod::simulation::shared {

/// Returns the islands of one process: [0, island_count) is divided into `size` ranges whose lengths differ by at most
/// 1. Requires size <= island_count.
inline base::Range share_of(std::size_t island_count, std::uint32_t rank, std::uint32_t size) {
    EVOD_ASSERT(rank < size);
    EVOD_ASSERT(size <= island_count);
    return {island_count * rank / size, island_count * (rank + 1) / size};
}

/// Returns the rank of the process that simulates an island; the inverse of share_of().
inline std::uint32_t rank_of(std::size_t island_count, std::size_t island, std::uint32_t size) {
    EVOD_ASSERT(island < island_count);
    return static_cast<std::uint32_t>(((island + 1) * size - 1) / island_count);
}

} // namespace evod::simulation::shared
