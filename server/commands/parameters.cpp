// `evod parameters` and `evod limits`: print the lists in docs/PARAMETERS.md and docs/OPERATIONS.md from the registries
// in the program.
#include "server/parameters/parameters.h"
#include "proto/command_line/command.h"
#include "server/commands/commands.h"
#include "server/network/limits.h"

#include <iostream>
#include <string>

namespace evod::commands {
namespace {

const char* effect_text(base::Effect effect) {
    switch (effect) {
    case base::Effect::NextTick:
        return "next tick";
    case base::Effect::NextGeneration:
        return "next generation";
    case base::Effect::Reset:
        return "reset";
    }
    return "";
}

/// A Markdown table with one row per parameter.
std::string parameter_list() {
    std::string text =
        "# Parameters\n\n"
        "All parameters of a world, as `evod parameters` prints them. The names are the same in experiment files, in\n"
        "`evod run --set`, in `evoctl` and in the protocol.\n\n"
        "A changed value takes effect from the moment in the column *takes effect*: at the *next tick*, when the\n"
        "*next generation* begins, or at a *reset* of the world. Parameters of breeding that take effect at the next\n"
        "tick are used by the next breeding.\n\n"
        "An experiment file may give a parameter values by generation, unless it takes effect at a reset:\n"
        "`\"mutation_chance\": {\"1\": 0.2, \"30\": 0.05}`. Each value holds from the first tick of its generation. A\n"
        "parameter of breeding therefore first acts when the following generation is bred. Before the first listed\n"
        "generation the parameter has its default.\n\n"
        "| name | default | allowed | unit | takes effect | meaning |\n|---|---|---|---|---|---|\n";
    for (const parameters::ParameterDescription& description : parameters::parameter_registry()) {
        text += "| `" + std::string{description.name} + "` | " + parameters::to_text(description.default_value()) +
                " | " + description.allowed() + " | " + std::string{description.unit} + " | " +
                effect_text(description.effect) + " | " + std::string{description.help} + " |\n";
    }
    return text;
}

} // namespace

void add_parameters_command(command_line::Command& app) {
    app.add_command("parameters", "Print every parameter, as in docs/PARAMETERS.md").action([] {
        std::cout << parameter_list();
    });
}

void add_limits_command(command_line::Command& app) {
    app.add_command("limits", "Print every limit of the network, as in docs/OPERATIONS.md").action([] {
        std::cout << network::limit_list();
    });
}

} // namespace evod::commands
