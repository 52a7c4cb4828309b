// Tournament: the contestants and winners of the tournament that led to one pick.
//
// Owner        none: a value.
// Threads      none.
#pragma once

#include "client/viewer/panels/breeding/breeding_record.h"

#include <cstdint>
#include <vector>

namespace evod::viewer {

struct Contestant {
    std::uint32_t organism = 0;
    bool won = false;
    bool picked_now = false; // whether the pick shown selected this contestant
};

/// Returns the contestants of the tournament that led to pick `index`, in the order drawn. All winners are marked. If
/// an organism was drawn several times, as many of its entries are marked as it has picks. Empty if the server sent no
/// contestants.
std::vector<Contestant> contestants_of(const BreedingRecord& record, std::uint32_t index);

} // namespace evod::viewer
