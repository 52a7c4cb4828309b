// Feeding: who touches which items of one kind after the tick's move, and who gets each.
//
// Threads      blocks of bodies are looked at side by side.
// Determinism  an item goes to its nearest toucher, of equally near ones to the lowest id, whatever the order of
//              search.
#pragma once

#include "server/physics/bodies.h"
#include "server/simulation/items.h"

#include <cstdint>
#include <span>
#include <vector>

namespace evod::simulation {

/// A body that touches an item.
struct Touch {
    std::uint32_t item, place; // where the item is, as Items tell
    float square;              // of the distance, px²
    std::uint32_t id, body;
    bool gets_it; // once award() has been called; of all who touch an item, one does
};

class Feeding {
  public:
    /// Before the blocks are looked at, which makes each forget what it had. blocks: how many there will be.
    void begin(std::size_t blocks);

    /// What some bodies touch; blocks may be done side by side. `at_items` holds every body of the block that touches
    /// an item.
    void find_touches(std::size_t block, std::span<const std::uint32_t> at_items, const physics::Circles& bodies,
                      const Items& items);

    /// Decides who gets what, of all blocks. Returns the number of items touched.
    std::size_t award();

    std::span<const Touch> touches(std::size_t block) const { return touches_of_block_[block]; }

  private:
    std::vector<std::vector<Touch>> touches_of_block_; // kept warm between ticks
    std::vector<Touch*> first_of_item_;                // open addressing, by item
};

} // namespace evod::simulation
