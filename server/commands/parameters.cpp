// `evod parameters`: prints docs/PARAMETERS.md from the registry in the program.
#include "proto/command_line/command.h"
#include "server/commands/commands.h"
#include "server/parameters/choice_help.h"
#include "server/parameters/model_parameters.h"

#include <iostream>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

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

/// "`food_count`, `selection`"
std::string names_of(std::span<const std::string_view> names) {
    std::string text;
    for (const std::string_view name : names) {
        text += (text.empty() ? "`" : ", `") + std::string{name} + "`";
    }
    return text;
}

std::string most_used_names() {
    std::vector<std::string_view> names;
    for (const parameters::ParameterDescription& description : parameters::parameter_registry()) {
        if (description.is_most_used) {
            names.push_back(description.name);
        }
    }
    return names_of(names);
}

/// A Markdown table for each topic, with one row per parameter.
std::string parameter_list() {
    std::string text =
        "# Parameters\n\n"
        "All parameters of a world, as `evod parameters` prints them. The names are the same in experiment files, in\n"
        "`evod run --set`, in `evoctl` and in the protocol.\n\n"
        "The column *takes effect* states when a changed value takes effect: at the *next tick*, when the\n"
        "*next generation* begins, or at a *reset* of the world. If a parameter of the genetic algorithm takes\n"
        "effect at the next tick, the next breeding uses its new value.\n\n"
        "An experiment file may list different values of a parameter for different generations:\n"
        "`\"mutation_chance\": {\"1\": 0.2, \"30\": 0.05}`. This is not possible for parameters that take effect at a\n"
        "reset. Each value holds from the first tick of its generation. A breeding parameter that is listed for\n"
        "generation N therefore first affects the breeding of generation N + 1. Before the first listed\n"
        "generation, the parameter has its default value.\n\n"
        "In worlds with births (`reproduction`), these parameters take effect at a reset, and the file gives each of\n"
        "them one value: " +
        names_of(parameters::kept_with_births()) +
        ".\n\n"
        "Genes are 32-bit floats with about seven significant digits: a gene of 1,000,000 has steps of 0.06.\n\n"
        "Users change these parameters most often: " +
        most_used_names() + ".\n";
    std::string_view topic;
    for (const parameters::ParameterDescription& description : parameters::parameter_registry()) {
        if (description.topic != topic) {
            topic = description.topic;
            text += "\n## " + std::string{topic} +
                    "\n\n| name | default | allowed | unit | takes effect | meaning |\n|---|---|---|---|---|---|\n";
        }
        text += "| `" + std::string{description.name} + "` | " + parameters::to_text(description.default_value()) +
                " | " + description.allowed() + " | " + std::string{description.unit} + " | " +
                effect_text(description.effect) + " | " + std::string{description.help} + " |\n";
    }
    text += "\n## Choices\n\n| parameter | choice | meaning |\n|---|---|---|\n";
    for (const parameters::ParameterDescription& description : parameters::parameter_registry()) {
        const auto* choice = std::get_if<parameters::ChoiceParameter>(&description.kind);
        if (choice != nullptr && !description.name.starts_with("predator_")) { // those have the choices of the prey's
            for (const std::string_view name : choice->names) {
                text += "| `" + std::string{description.name} + "` | " + std::string{name} + " | " +
                        std::string{parameters::choice_help(description.name, name)} + " |\n";
            }
        }
    }
    return text;
}

} // namespace

void add_parameters_command(command_line::Command& app) {
    app.add_command("parameters", "Print every parameter, as in docs/PARAMETERS.md").group("Help").action([] {
        std::cout << parameter_list();
    });
}

} // namespace evod::commands
