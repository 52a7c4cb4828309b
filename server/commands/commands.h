// Commands: the server that `evod` starts, and the subcommands of `evod`. Each function below adds one of them to the
// program, with its options, its help and its action. The source file has the same name: run.cpp defines
// add_run_command().
//
// An action reads the files that its options name, prints its result to stdout, and prints progress and errors to
// stderr. It returns the exit status. Status 0 means success, unless the help of the command says otherwise.
//
// Owner    the main thread.
// Threads  the main thread. Actions start their own worker threads and join them.
#pragma once

namespace evod::command_line {
class Command;
}

namespace evod::commands {

/// Adds the action of `evod` without a subcommand: it starts the server.
void add_server(command_line::Command& app);

void add_run_command(command_line::Command& app);
void add_compare_command(command_line::Command& app);
void add_sweep_command(command_line::Command& app);
void add_check_command(command_line::Command& app);
void add_lesson_command(command_line::Command& app);
void add_check_config_command(command_line::Command& app);
void add_fork_command(command_line::Command& app);
void add_replay_command(command_line::Command& app);
void add_verify_command(command_line::Command& app);
void add_export_command(command_line::Command& app);
void add_backup_command(command_line::Command& app);
void add_data_command(command_line::Command& app);
void add_prune_command(command_line::Command& app);
void add_token_command(command_line::Command& app);
void add_certificate_command(command_line::Command& app);
void add_parameters_command(command_line::Command& app);
void add_limits_command(command_line::Command& app);

/// Whether this process is a server, which writes its errors to the log. May be called from any thread.
bool is_server();

} // namespace evod::commands
