// Colony: a world with births or with two species, and what an island hands over from one generation to the next.
//
// With births, a generation is an interval: nothing happens to the organisms when it ends. The living keep their
// places, health and ages, and get new ids: first the prey, then the predators, each in the order of their previous
// ids. A migrant gets the id of the organism that it replaces. An organism has one number on its island for its whole
// life. What begins an interval is an IslandOpening, from which the interval is computed again at any time.
//
// Determinism  an opening is a function of the state at the end of the interval before it.
#pragma once

#include "server/simulation/world_state.h"

#include <cstdint>
#include <vector>

namespace evod::simulation {

/// Returns whether a world has births or a second species.
inline bool is_colony(const parameters::Parameters& parameters) {
    return parameters::has_births(parameters) || parameters.predator_count > 0;
}

/// The island of a world with births at the beginning of an interval.
struct IslandOpening {
    std::uint32_t predator_count = 0;              // the last organisms
    std::uint32_t next_number = 0;                 // number of the next organism that is born or placed
    std::vector<std::uint32_t> numbers, age_ticks; // by id; ages at the beginning of the interval
    IslandState state;                             // all organisms are alive, and nothing has been placed

    friend bool operator==(const IslandOpening&, const IslandOpening&) = default;
};

} // namespace evod::simulation
