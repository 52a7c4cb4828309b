// `evod check`: validates an experiment file without running it.
#include "proto/command_line/command.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"
#include "server/experiments/experiment_file.h"

#include <iostream>
#include <string>

namespace evod::commands {
namespace {

/// Prints the parameters that the file changes, or the errors in it. Returns the exit status.
int check(const std::string& path) {
    const base::Result<parameters::Experiment> experiment = experiments::load_experiment(path);
    if (!experiment) {
        return fail(experiment.error());
    }
    std::cout << path << ": valid";
    if (!experiment->description.empty()) {
        std::cout << "\n" << experiment->description;
    }
    const std::string changes =
        parameters::to_experiment_text(experiment->parameters, parameters::Written::Differences, experiment->schedule);
    if (changes == "{}\n") {
        std::cout << "\nEvery parameter has its default.\n";
    } else {
        std::cout << "\nParameters that differ from their defaults:\n" << changes;
    }
    return 0;
}

} // namespace

void add_check_command(command_line::Command& app) {
    auto& command = app.add_command("check", "Check an experiment file and print the parameters that it changes")
                        .group("Experiments");
    auto& path = command.keep(std::string{});
    command.add_option("experiment", &path, "Experiment file (JSON)").required();
    command.action([&] { return check(path); });
}

} // namespace evod::commands
