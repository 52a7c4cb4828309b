// evod fork: a second world from a past generation of a run file.
#pragma once

#include "server/simulation/commands.h"

#include <cstdint>
#include <string>

namespace evod::console {

struct ForkOptions {
    std::string run_file;
    std::uint64_t at_generation = 0;
    std::string name;        // of the new world
    std::string data_folder; // where it is made
    simulation::RunId run_id;
};

/// Says what it made, or why not; returns the exit status.
int fork(const ForkOptions& options);

} // namespace evod::console
