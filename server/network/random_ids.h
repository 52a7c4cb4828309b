// Random seeds and ids that the server draws: seeds without a client's choice, run ids, instance ids.
#pragma once

#include "server/base/random.h"
#include "server/simulation/commands.h"

namespace evod::network {

base::Seed draw_seed();
simulation::RunId draw_run_id();

} // namespace evod::network
