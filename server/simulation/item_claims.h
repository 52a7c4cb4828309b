// Item claims: finds which bodies touch which items of one kind after the tick's move, and which body gets each item.
//
// Threads      blocks of bodies are searched in parallel.
// Determinism  an item goes to the nearest body that touches it; if bodies are equally near, to the one with the lowest
//              id. The order of the search does not matter.
#pragma once

#include "server/physics/bodies.h"
#include "server/simulation/items.h"

#include <cstdint>
#include <span>
#include <vector>

namespace evod::simulation {

/// A body that touches an item.
struct Touch {
    std::uint32_t item, place; // place: as TwoNearest::place
    float square;              // squared distance, px²
    std::uint32_t id, body;
    bool gets_it; // valid after award(); exactly one body that touches an item gets it
};

class ItemClaims {
  public:
    /// Prepares a search of `blocks` blocks. find_touches() clears the previous touches of its block.
    void begin(std::size_t blocks);

    /// Finds which bodies of a block touch items. Blocks may be searched in parallel. `at_items` must contain every
    /// body of the block that touches an item; it may contain other bodies.
    void find_touches(std::size_t block, std::span<const std::uint32_t> at_items, const physics::Circles& bodies,
                      const Items& items);

    /// Decides which body gets each item, after all blocks have been searched. Returns the number of touched items.
    std::size_t award();

    std::span<const Touch> touches(std::size_t block) const { return touches_of_block_[block]; }

  private:
    std::vector<std::vector<Touch>> touches_of_block_; // kept between ticks
    std::vector<Touch*> first_of_item_;                // hash table with open addressing, by item
};

} // namespace evod::simulation
