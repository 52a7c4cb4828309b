// `evod verify`: a run file held against a new simulation of its run.
#pragma once

#include <cstddef>
#include <string>

namespace evod::command_line {
class Command;
}

namespace evod::commands {

struct VerifyOptions {
    std::string run; // path of a run file
    std::size_t threads = 1;
};

/// What was compared to stdout, or where the two part to stderr. Returns the exit status: 0 if all agrees, 1 if it does
/// not, or if the file cannot be read, is damaged or follows another model.
int verify(const VerifyOptions& options);

void add_verify_command(command_line::Command& app, std::size_t threads);

} // namespace evod::commands
