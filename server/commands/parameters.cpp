// `evod parameters` and `evod limits`: print the tables in docs/PARAMETERS.md and docs/OPERATIONS.md from the
// registries in the program.
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
        "The column *takes effect* states when a changed value takes effect: at the *next tick*, when the\n"
        "*next generation* begins, or at the next *reset* of the world. A change of a breeding parameter that takes\n"
        "effect at the next tick affects the next breeding.\n\n"
        "An experiment file may schedule different values of a parameter for different generations, unless the\n"
        "parameter takes effect only at a reset: `\"mutation_chance\": {\"1\": 0.2, \"30\": 0.05}`. Each value "
        "applies\n"
        "from the first tick of its generation. A breeding parameter set for generation N therefore first affects the\n"
        "breeding of generation N + 1. Before the first listed generation the parameter has its default value.\n\n"
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
    app.add_command("parameters", "Print the table of all parameters in docs/PARAMETERS.md").action([] {
        std::cout << parameter_list();
    });
}

void add_limits_command(command_line::Command& app) {
    app.add_command("limits", "Print the table of all network limits in docs/OPERATIONS.md").action([] {
        std::cout << network::limit_list();
    });
}

} // namespace evod::commands
