#include "server/commands/fork.h"

#include "proto/command_line/command.h"
#include "server/base/inline_executor.h"
#include "server/commands/common_options.h"
#include "server/replay/fork.h"
#include "server/run_file/data_folder.h"
#include "server/simulation/world_name.h"

#include <filesystem>
#include <iostream>

namespace evod::commands {

int fork(const ForkOptions& options) {
    const auto fail = [](const std::string& why) {
        std::cerr << "evod fork: " << why << '\n';
        return 1;
    };
    if (!simulation::is_world_name(options.name)) {
        return fail("--name: got \"" + options.name + "\", allowed " + std::string{simulation::world_name_allowed});
    }
    // Only read, so a server may be writing it.
    const auto origin = run_file::RunFile::open_checked(options.run_file);
    if (!origin) {
        return fail(to_text(origin.error()));
    }
    if (const auto held = (*origin)->pin_snapshot(); !held) { // what is thinned meanwhile is still there
        return fail(to_text(held.error()));
    }
    const auto folder = run_file::DataFolder::open(options.data_folder);
    if (!folder) {
        return fail(to_text(folder.error()));
    }
    const std::string path = folder->file_of(options.name);
    base::InlineExecutor executor;
    const auto moment = replay::fork(**origin, options.at_generation, path, options.name, options.run_id, executor);
    if (!moment) {
        base::Refusal refused = moment.error();
        for (base::Violation& violation : refused.violations) {
            if (violation.field == "generation") {
                violation.field = "--at-generation";
            }
        }
        return fail(to_text(refused));
    }
    std::cout << "world \"" << options.name << "\" begins with "
              << (options.at_generation ? "" : "tick " + std::to_string(moment->generation_tick) + " of ")
              << "generation " << moment->generation << " of " << options.run_file << "; a server with --data "
              << options.data_folder << " finds it, and lets it wait\n";
    return 0;
}

void add_fork_command(command_line::Command& app, std::function<simulation::RunId()> draw_run_id) {
    auto& command =
        app.add_command("fork", "Make a second world from a past generation of a run file, or from where it ends");
    auto& options = command.keep(ForkOptions{});
    command.add_option("run", &options.run_file, "Run file, of a server that runs or not").required();
    command
        .add_option("--at-generation", &options.at_generation,
                    "Begins with its first tick; otherwise with the last moment of the file")
        .check(generation_number);
    command.add_option("--name", &options.name, "Of the new world").required();
    command.add_option("--data", &options.data_folder,
                       "Folder to make it in, which no server may be using; otherwise that of the run file");
    command.footer(
        "It has the seed, the organisms and the parameters that the run had then, and waits to be told to run.");
    command.action([&options, draw_run_id = std::move(draw_run_id)] {
        options.run_id = draw_run_id();
        if (options.data_folder.empty()) {
            const std::string folder = std::filesystem::path{options.run_file}.parent_path().string();
            options.data_folder = folder.empty() ? "." : folder;
        }
        return fork(options);
    });
}

} // namespace evod::commands
