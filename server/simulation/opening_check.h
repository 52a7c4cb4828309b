// Opening check: finds what no island can have written in the opening of an interval. A run file may contain anything;
// the core relies on what is checked here.
#pragma once

#include "server/evolution/next_generation.h"
#include "server/simulation/colony.h"

namespace evod::simulation {

/// Returns why an interval cannot begin with this opening; nullptr if it can.
///
/// bred        the organisms of the island.
/// parameters  with which the interval begins; valid.
const char* fault_of(const IslandOpening& opening, const evolution::NextGeneration& bred,
                     const parameters::Parameters& parameters);

} // namespace evod::simulation
