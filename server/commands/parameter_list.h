// `evod parameters`: the registry of parameters as a table; docs/PARAMETERS.md is what it prints.
#pragma once

namespace evod::command_line {
class Command;
}

namespace evod::commands {

void add_parameters_command(command_line::Command& app);

} // namespace evod::commands
