// `evod check-config`: checks a configuration file of the server without starting one.
#include "proto/command_line/command.h"
#include "proto/command_line/terminal.h"
#include "proto/command_line/words.h"
#include "server/commands/commands.h"
#include "server/commands/serve_options.h"
#include "server/network/server.h"

#include <iostream>
#include <string>
#include <vector>

namespace evod::commands {
namespace {

/// Prints everything that is wrong with the file. Returns the exit status.
int check_config(const std::string& path) {
    command_line::Command server{"evod", "", ""};
    ServeOptions options;
    add_all_options(server, options);
    std::vector<std::string> errors = server.read({"--config=" + path});
    if (errors.empty()) { // what concerns several options, or the files that they name
        const auto configuration = server_options(options);
        const auto sound = configuration ? network::Server::check(configuration->listeners) : configuration.error();
        if (!sound) {
            errors.push_back(path + ": " + base::to_text(sound.error()));
        }
    }
    if (errors.empty()) {
        std::cout << path << ": valid\n";
        return 0;
    }
    command_line::print_error("evod", command_line::joined(errors, "\n"));
    return command_line::exit_usage;
}

} // namespace

void add_check_config_command(command_line::Command& app) {
    auto& command = app.add_command("check-config", "Check a configuration file of the server").group("Server");
    auto& path = command.keep(std::string{});
    command.add_option("file", &path, "Configuration file, such as /etc/evod/evod.conf").required();
    command.footer("Exit status: 0 the file is valid, 2 it is not; each error names its line.");
    command.action([&path] { return check_config(path); });
}

} // namespace evod::commands
