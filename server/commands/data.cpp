// `evod data`: lists the runs of a data folder, and which of them a server of this version continues.
#include "proto/command_line/command.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"
#include "server/run_file/data_folder.h"
#include "server/run_file/ended_runs.h"
#include "server/run_file/run_file.h"
#include "server/simulation/model_version.h"

#include <cstdio>
#include <filesystem>
#include <string>

namespace evod::commands {
namespace {

/// What this version of evod can do with a run.
///
/// is_of_world  the file has the name of the present run of a world.
const char* use_of(run_file::RunFile& file, bool is_of_world) {
    const auto mark = file.end_mark();
    if (!mark) {
        return "unreadable";
    }
    const bool is_over = *mark && (*mark)->ended;
    return file.other_model() ? "read only" : is_over ? "ended" : is_of_world ? "continues" : "not used";
}

/// Prints a line for each run file. Returns the exit status.
int list_runs(const std::string& folder) {
    const auto files = run_file::DataFolder::files_in(folder);
    if (!files) {
        return fail(files.error());
    }
    std::printf("%-40s %5s %14s  %-8s %s\n", "FILE", "MODEL", "BYTES", "EVOD", "STATE");
    int status = 0;
    for (const auto* paths : {&files->of_worlds, &files->ended}) {
        for (const std::string& path : *paths) {
            const std::string name = std::filesystem::path{path}.filename().string();
            const auto bytes =
                static_cast<unsigned long long>(run_file::bytes_of_run(path)); // before SQLite adds files
            const auto file = run_file::RunFile::open_checked(path);
            if (!file) {
                std::printf("%-40s %5s %14llu  %-8s %s\n", name.c_str(), "?", bytes, "?", "unreadable");
                status = fail(file.error());
                continue;
            }
            const run_file::RunIdentity& identity = (*file)->identity();
            std::printf("%-40s %5llu %14llu  %-8s %s\n", name.c_str(),
                        static_cast<unsigned long long>(identity.model_version), bytes, identity.evod_version.c_str(),
                        use_of(**file, paths == &files->of_worlds));
        }
    }
    return status;
}

} // namespace

void add_data_command(command_line::Command& app) {
    auto& command =
        app.add_command("data", "List the runs of a data folder, also while a server uses it").group("Run files");
    auto& folder = command.keep(std::string{});
    command.add_option("--data", &folder,
                       "Data folder of the server; default: $XDG_STATE_HOME/evod or ~/.local/state/evod");
    command.footer(
        "States: continues: a server of this version restores the world; ended: the run is complete; read only: the "
        "run has another model version, so evod export reads it, but no server continues it; not used: the file is a "
        "copy under a name that no server reads; unreadable: the file is damaged, or a newer evod wrote it. The rows "
        "are not checked: evod verify does so. Exit status 1: a file is unreadable.");
    command.action([&folder] { return find_data_folder(folder) ? list_runs(folder) : exit_error; });
}

} // namespace evod::commands
