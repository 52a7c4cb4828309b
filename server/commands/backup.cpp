// `evod backup`: copies a data folder, also while a server uses it.
#include "server/run_file/backup.h"
#include "proto/command_line/command.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"

#include <iostream>
#include <string>

namespace evod::commands {
namespace {

/// Prints what was copied to stdout, and what could not be copied to stderr. Returns the exit status.
int back_up(const std::string& data, const std::string& folder) {
    const auto backup = run_file::back_up(data, folder);
    if (!backup) {
        return fail(backup.error());
    }
    for (const std::string& failure : backup->failures) {
        fail("not copied: " + failure);
    }
    const auto counted = [](std::size_t count, const char* noun) {
        return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
    };
    std::cout << folder << ": " << counted(backup->worlds, "world") << ", " << counted(backup->ended, "ended run")
              << (backup->has_tokens && backup->has_classes ? ", the tokens and the classes"
                  : backup->has_tokens                      ? " and the tokens"
                  : backup->has_classes                     ? " and the classes"
                                                            : "")
              << ", " << backup->bytes << " bytes\n";
    return backup->failures.empty() ? 0 : exit_error;
}

} // namespace

void add_backup_command(command_line::Command& app) {
    auto& command = app.add_command("backup", "Copy a data folder, also while a server uses it").group("Run files");
    struct Options {
        std::string data, folder;
    };
    auto& options = command.keep(Options{});
    command
        .add_option("folder", &options.folder,
                    "Folder for the copy; it must be empty or must not exist; a server started with it as --data "
                    "continues all worlds")
        .required();
    command.add_option("--data", &options.data,
                       "Data folder of the server; default: $XDG_STATE_HOME/evod or ~/.local/state/evod");
    command.footer(
        "Exit status: 0 everything was copied, 1 a file could not be copied (the others are in the copy), or "
        "there is no copy. Each copy is checked.");
    command.action(
        [&options] { return find_data_folder(options.data) ? back_up(options.data, options.folder) : exit_error; });
}

} // namespace evod::commands
