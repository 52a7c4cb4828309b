// evod fork: a second world from a past generation of a run file.
#pragma once

#include "server/simulation/commands.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace evod::command_line {
class Command;
}

namespace evod::commands {

struct ForkOptions {
    std::string run_file;
    std::optional<std::uint64_t> at_generation; // nullopt: at the last moment that the file tells of
    std::string name;                           // of the new world
    std::string data_folder;                    // where it is made
    simulation::RunId run_id;
};

/// Says what it made, or why not; returns the exit status.
int fork(const ForkOptions& options);

void add_fork_command(command_line::Command& app, std::function<simulation::RunId()> draw_run_id);

} // namespace evod::commands
