// Share: the islands of a world that this process simulates. The other islands of the world are simulated by other
// processes, with which World exchanges results (sharing.h).
//
// Every process has neighbouring islands, because neighbours of a ring exchange migrants.
#pragma once

#include "server/base/executor.h"
#include "server/base/state_hash.h"

#include <cstddef>
#include <cstdint>

namespace evod::simulation {

/// Returns the islands of one process: [0, island_count) is divided into `size` ranges whose lengths differ by at most
/// 1. Requires size <= island_count.
base::Range share_of(std::size_t island_count, std::uint32_t rank, std::uint32_t size);

/// Returns the rank of the process that simulates an island; the inverse of share_of().
std::uint32_t rank_of(std::size_t island_count, std::size_t island, std::uint32_t size);

/// Calls body(i) for every island i of `share`, on the threads of the executor.
template <class Body>
void for_each_island(base::Range share, base::Executor& executor, Body&& body) {
    executor.parallel_for(share.end - share.begin, 1, [&](base::Range range) {
        for (std::size_t i = share.begin + range.begin; i < share.begin + range.end; ++i) {
            body(i);
        }
    });
}

/// An island that rank 0 orders from another process.
struct WantedIsland {
    std::uint32_t island;
    bool with_organisms; // not only its state, because rank 0 does not have its organisms yet
};

/// What the other processes of a world know about an island.
struct IslandSummary {
    base::StateHash hash;
    std::uint32_t alive_count = 0, organism_count = 0;
    bool is_as_begun = false; // Island::is_as_begun(), at the first moment of a generation
};

} // namespace evod::simulation
