// Feeding: who touches which items after the tick's move, and who gets each.
//
// Threads      organisms are looked at in blocks side by side; what each block found is put together in order.
// Determinism  an item goes to its nearest toucher, of equally near ones to the lowest id, whatever the order of
// search.
#pragma once

#include "server/base/executor.h"
#include "server/physics/bodies.h"
#include "server/simulation/behaviour.h"
#include "server/simulation/items.h"

#include <cstdint>
#include <vector>

namespace evod::simulation {

/// An item and the body that gets it.
struct Meal {
    std::uint32_t item, body;
};

class Feeding {
  public:
    /// Who gets which of the items touched now, in rising order of item. Changes nothing.
    ///
    /// seen_distance  of `sight`, for this kind of item: px; no item was nearer than that at the start of the tick.
    const std::vector<Meal>& meals(const physics::Circles& bodies, const Items& items, const Sight& sight,
                                   const std::vector<float>& seen_distance, base::Executor& executor);

  private:
    struct Touch {
        std::uint32_t item;
        float square; // of the distance, px²
        std::uint32_t id, body;
    };
    std::vector<std::vector<Touch>> touches_of_block_; // kept warm between ticks
    std::vector<Touch> touches_;
    std::vector<Meal> meals_;
};

} // namespace evod::simulation
