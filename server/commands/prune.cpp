// `evod prune`: deletes old runs of a data folder, also while a server uses it.
#include "proto/command_line/command.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"
#include "server/run_file/ended_runs.h"

#include <cstdint>
#include <iostream>
#include <string>

namespace evod::commands {
namespace {

struct PruneOptions {
    std::string data;
    std::uint64_t keep_runs = 0;
    bool dry_run = false;
};

/// Prints the runs that it deletes. Returns the exit status.
int prune(const PruneOptions& options) {
    run_file::Pruned pruned;
    if (options.dry_run) {
        auto runs = run_file::surplus_runs(options.data, options.keep_runs);
        if (!runs) {
            return fail(runs.error());
        }
        pruned.deleted = *std::move(runs);
    } else {
        auto result = run_file::prune(options.data, options.keep_runs);
        if (!result) {
            return fail(result.error());
        }
        pruned = *std::move(result);
    }
    std::uint64_t bytes = 0;
    for (const run_file::EndedRun& run : pruned.deleted) {
        std::cout << run.path << ": " << run.bytes << " bytes\n";
        bytes += run.bytes;
    }
    std::cout << (options.dry_run ? "would delete " : "deleted ") << pruned.deleted.size()
              << (pruned.deleted.size() == 1 ? " run, " : " runs, ") << bytes << " bytes\n";
    for (const std::string& failure : pruned.failures) {
        fail(failure);
    }
    return pruned.failures.empty() ? 0 : exit_error;
}

} // namespace

void add_prune_command(command_line::Command& app) {
    auto& command =
        app.add_command("prune", "Delete old runs that have ended, also while a server runs").group("Run files");
    auto& options = command.keep(PruneOptions{});
    command
        .add_option("--keep-runs", &options.keep_runs,
                    "Keep the newest N ended runs of each world; its present run always stays")
        .check(any_number)
        .required();
    command.add_flag("--dry-run", &options.dry_run, "Only print what would be deleted");
    command.add_option("--data", &options.data,
                       "Data folder of the server; default: $XDG_STATE_HOME/evod or ~/.local/state/evod");
    command.action([&options] { return find_data_folder(options.data) ? prune(options) : exit_error; });
}

} // namespace evod::commands
