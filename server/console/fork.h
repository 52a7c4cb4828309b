// evod fork: a second world from a past generation of a run file.
#pragma once

#include "server/simulation/commands.h"

#include <cstdint>
#include <optional>
#include <string>

namespace evod::console {

struct ForkOptions {
    std::string run_file;
    std::optional<std::uint64_t> at_generation; // nullopt: at the last moment that the file tells of
    std::string name;                           // of the new world
    std::string data_folder;                    // where it is made
    simulation::RunId run_id;
};

/// Says what it made, or why not; returns the exit status.
int fork(const ForkOptions& options);

} // namespace evod::console
