// The entry point of evod. Registers all subcommands; see server/commands/commands.h.
#include "proto/command_line/completion.h"
#include "proto/command_line/terminal.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"
#include "server/commands/termination.h"
#include "server/runtime/processes.h"

#include <google/protobuf/stubs/logging.h>

#include <csignal>
#include <cstdio>
#include <iostream>
#include <optional>
#include <string>

namespace evod {
namespace {

/// Runs the command that the user has given, and returns its exit status. Refuses subcommands that would do the same
/// work in each process that mpirun has started.
int run(command_line::Command& app) {
    const command_line::Command* const command = app.given_command();
    const std::string name = command == nullptr ? "" : command->name();
    if (command != nullptr && name != "run" && name != "sweep" && runtime::is_one_of_several()) {
        command_line::print_error("evod",
                                  "evod " + name + " cannot share its work among processes: start it without mpirun");
        return command_line::exit_usage;
    }
    return app.run();
}

} // namespace
} // namespace evod

int main(int argument_count, char** arguments) {
    using namespace evod::commands;
    install_termination_handler();
    // With this, writing beyond the limit of `ulimit -f` fails like writing to a full disk. Otherwise it would end the
    // process.
    std::signal(SIGXFSZ, SIG_IGN);
    // The server reports a malformed message to its sender. Without this, protobuf would also log each message, and any
    // client could fill the log.
    google::protobuf::SetLogHandler(nullptr);

    evod::command_line::Command app{"evod", "evod: an evolution laboratory that runs as a server",
                                    "evod " EVOD_VERSION};
    app.environment("EVOD_INSTRUCTIONS",
                    "The vector instructions to use: baseline, avx2 or avx512; default: the best of this "
                    "processor. All give the same results.");
    add_server(app);
    add_run_command(app);
    add_compare_command(app);
    add_sweep_command(app);
    add_check_command(app);
    add_lesson_command(app);
    add_fork_command(app);
    add_replay_command(app);
    add_verify_command(app);
    add_export_command(app);
    add_backup_command(app);
    add_data_command(app);
    add_prune_command(app);
    add_check_config_command(app);
    add_token_command(app);
    add_certificate_command(app);
    add_parameters_command(app);
    add_limits_command(app);
    add_help_commands(app);

    if (complete(app, argument_count, arguments)) {
        return 0;
    }
    const std::optional<int> ended = app.parse(argument_count, arguments);
    const int status = ended ? *ended : use_instructions_of_environment() ? evod::run(app) : exit_error;
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.flush()) {
        return status;
    }
    evod::command_line::print_error("evod", "standard output cannot be written: the disk may be full");
    return status == 0 ? 1 : status;
}
