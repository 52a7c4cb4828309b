// Random ids: ids of runs and of server instances, and seeds that the user did not choose. They come from
// std::random_device, which the core must not use.
//
// Threads      any.
#pragma once

#include "server/base/random.h"
#include "server/simulation/commands.h"

namespace evod::runtime {

base::Seed draw_seed(); // below 2^53: base::portable_seed()
simulation::RunId draw_run_id();

} // namespace evod::runtime
