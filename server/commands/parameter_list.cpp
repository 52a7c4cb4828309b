#include "server/commands/parameter_list.h"

#include "proto/command_line/command.h"
#include "server/parameters/parameters.h"

#include <iostream>

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

/// Markdown, one row a parameter.
std::string parameter_list() {
    std::string text =
        "# Parameters\n\n"
        "Every parameter of a world, as `evod parameters` prints it. The names are the same in experiment files, with\n"
        "`evod run --set`, in `evoctl` and in the protocol. A change to one that holds from the *next tick* acts at\n"
        "once, for breeding the next time it happens; from the *next generation*, when that begins; from a *reset*,\n"
        "when the world is reset.\n\n"
        "An experiment file may give a parameter values by generation, unless it holds from a reset:\n"
        "`\"mutation_chance\": {\"1\": 0.2, \"30\": 0.05}`. Each holds from the first tick of its generation, so what "
        "breeding\n"
        "goes by acts first in the breeding after it; until the first of them, the default holds.\n\n"
        "| name | default | allowed | unit | holds from | meaning |\n|---|---|---|---|---|---|\n";
    for (const parameters::ParameterDescription& description : parameters::parameter_registry()) {
        text += "| `" + std::string{description.name} + "` | " + parameters::to_text(description.default_value()) +
                " | " + description.allowed() + " | " + std::string{description.unit} + " | " +
                effect_text(description.effect) + " | " + std::string{description.help} + " |\n";
    }
    return text;
}

} // namespace

void add_parameters_command(command_line::Command& app) {
    app.add_command("parameters", "Print every parameter, as docs/PARAMETERS.md has it").action([] {
        std::cout << parameter_list();
    });
}

} // namespace evod::commands
