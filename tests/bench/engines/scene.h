// A scene: an island's first generation, by whichever program, ready to be run and looked at.
#pragma once

#include "tests/bench/engines/start_state.h"

#include <cstdint>
#include <vector>

namespace evod::bench {

/// Since the start.
struct Counts {
    std::uint64_t food_eaten = 0, poison_eaten = 0, deaths = 0;
};

/// The living and the food as they are between two ticks.
struct Observation {
    struct Organism {
        Vector place, velocity; // px, px/s
        double food_radius;     // px
    };
    std::vector<Organism> organisms;
    std::vector<Vector> food;
};

} // namespace evod::bench
