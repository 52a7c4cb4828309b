// What the shell draws by chance: seeds nobody gave, names of runs and of this start of the server.
#pragma once

#include "server/base/random.h"
#include "server/simulation/commands.h"

namespace evod::network {

base::Seed draw_seed();
simulation::RunId draw_run_id();

} // namespace evod::network
