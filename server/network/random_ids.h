// Random numbers of the server: ids of runs, ids of server instances, and seeds that the client did not choose.
#pragma once

#include "server/base/random.h"
#include "server/simulation/commands.h"

namespace evod::network {

base::Seed draw_seed();
simulation::RunId draw_run_id();

} // namespace evod::network
