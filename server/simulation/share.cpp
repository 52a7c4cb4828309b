#include "server/simulation/share.h"

#include "server/base/assert.h"

namespace evod::simulation {

base::Range share_of(std::size_t island_count, std::uint32_t rank, std::uint32_t size) {
    EVOD_ASSERT(rank < size);
    EVOD_ASSERT(size <= island_count);
    return {island_count * rank / size, island_count * (rank + 1) / size};
}

std::uint32_t rank_of(std::size_t island_count, std::size_t island, std::uint32_t size) {
    EVOD_ASSERT(island < island_count);
    return static_cast<std::uint32_t>(((island + 1) * size - 1) / island_count);
}

} // namespace evod::simulation
