// `evod fork`: creates a new world that begins with a generation of a stored run.
#include "proto/command_line/command.h"
#include "server/base/inline_executor.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"
#include "server/replay/run_file_fork.h"
#include "server/run_file/data_folder.h"
#include "server/runtime/random_ids.h"
#include "server/simulation/world_name.h"

#include <cstdint>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>

namespace evod::commands {
namespace {

struct ForkOptions {
    std::string run_file;
    std::optional<std::uint64_t> at_generation; // nullopt: fork the last tick of the file
    std::string name;                           // name of the new world
    std::string data_folder;                    // folder for the new run file
};

/// Replaces the field names of requests with the names of the command line options.
base::Refusal with_fork_options(base::Refusal refused) {
    for (base::Violation& violation : refused.violations) {
        if (violation.field == "generation") {
            violation.field = "--at-generation";
        }
    }
    return refused;
}

/// Prints a description of the new world, or an error. Returns the exit status.
int fork(const ForkOptions& options) {
    if (!simulation::is_world_name(options.name)) {
        return fail("--name: got \"" + options.name + "\", allowed " + std::string{simulation::world_name_allowed});
    }
    // fork() only reads the origin, so a server may write to that file at the same time.
    const auto origin = run_file::RunFile::open_checked(options.run_file);
    if (!origin) {
        return fail(origin.error());
    }
    // Uses a snapshot of the file, so that a server cannot purge a generation while fork() reads it.
    if (const auto held = (*origin)->pin_snapshot(); !held) {
        return fail(held.error());
    }
    const auto folder = run_file::DataFolder::open(options.data_folder);
    if (!folder) {
        return fail(folder.error());
    }
    base::InlineExecutor executor;
    const auto moment = replay::fork(**origin, options.at_generation, folder->file_of(options.name), options.name,
                                     runtime::draw_run_id(), executor);
    if (!moment) {
        return fail(with_fork_options(moment.error()));
    }
    std::cout << "world \"" << options.name << "\" begins with "
              << (options.at_generation ? "" : "tick " + std::to_string(moment->generation_tick) + " of ")
              << "generation " << moment->generation << " of " << options.run_file << "; a server with --data "
              << options.data_folder << " restores it, paused\n";
    return 0;
}

} // namespace

void add_fork_command(command_line::Command& app) {
    auto& command =
        app.add_command("fork", "Create a new world from a generation of a stored run, or from the end of the run")
            .group("Run files");
    auto& options = command.keep(ForkOptions{});
    command.add_option("run", &options.run_file, "Run file, NAME.evod; the run may still be in progress").required();
    command
        .add_option("--at-generation", &options.at_generation,
                    "The fork begins with the first tick of this generation; default: the last tick in the file")
        .check(generation_number);
    command.add_option("--name", &options.name, "Name of the new world").required();
    command.add_option(
        "--data", &options.data_folder,
        "Folder for the new run file, which no running server may use; default: the folder of the run file");
    command.footer(
        "The fork has the seed, the organisms and the parameters of the run at that tick. It is paused until "
        "a client runs it.");
    command.action([&options] {
        if (options.data_folder.empty()) {
            const std::string folder = std::filesystem::path{options.run_file}.parent_path().string();
            options.data_folder = folder.empty() ? "." : folder;
        }
        return fork(options);
    });
}

} // namespace evod::commands
