// `evod limits`: prints the list in docs/OPERATIONS.md from the table in the program.
#include "server/network/limits.h"
#include "proto/command_line/command.h"
#include "server/commands/commands.h"

#include <iostream>

namespace evod::commands {

void add_limits_command(command_line::Command& app) {
    app.add_command("limits", "Print every limit of the network, as in docs/OPERATIONS.md").group("Help").action([] {
        std::cout << network::limit_list();
    });
}

} // namespace evod::commands
