// A tournament as it was held, around one pick.
//
// Threads      none.
#pragma once

#include "client/viewer/panels/breeding/breeding_record.h"

#include <cstdint>
#include <vector>

namespace evod::viewer {

struct Contestant {
    std::uint32_t organism = 0;
    bool won = false;
    bool picked_now = false; // with the pick that is looked at
};

/// The contestants of the tournament that pick `index` won, as they were drawn. With several winners all of them are
/// marked; who was drawn twice has won once for each of its picks. Empty where they are not known.
std::vector<Contestant> contestants_of(const BreedingRecord& record, std::uint32_t index);

} // namespace evod::viewer
