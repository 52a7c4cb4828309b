// Commands: the server that `evod` starts, and its subcommands. Each function below adds one of them, with its options,
// its help and its action, to the program. Each is defined in the source of its name: add_run_command() in run.cpp.
//
// An action reads files that its options name, prints its result to stdout, and prints progress and errors to stderr.
// It returns the exit status: 0 for success, unless its help lists others.
//
// Owner    main.
// Threads  main's. Actions start worker threads of their own and join them.
#pragma once

namespace evod::command_line {
class Command;
}

namespace evod::commands {

/// What `evod` without a subcommand does: it serves.
void add_server(command_line::Command& app);

void add_run_command(command_line::Command& app);
void add_compare_command(command_line::Command& app);
void add_sweep_command(command_line::Command& app);
void add_check_command(command_line::Command& app);
void add_fork_command(command_line::Command& app);
void add_replay_command(command_line::Command& app);
void add_verify_command(command_line::Command& app);
void add_export_command(command_line::Command& app);
void add_token_command(command_line::Command& app);
void add_certificate_command(command_line::Command& app);
void add_parameters_command(command_line::Command& app);
void add_limits_command(command_line::Command& app);

/// Whether stdout is a log: a server has started. From any thread.
bool standard_output_is_log();

} // namespace evod::commands
