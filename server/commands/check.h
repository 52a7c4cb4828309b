// `evod check`: validates an experiment file without running it.
#pragma once

#include <string>

namespace evod::command_line {
class Command;
}

namespace evod::commands {

/// Prints what the file changes from the defaults, or what is wrong with it. Returns the exit status: 0, or 1 if wrong.
int check(const std::string& path);

void add_check_command(command_line::Command& app);

} // namespace evod::commands
