// Parameters: set, get, params.
#include "client/ctl/caller.h"
#include "client/ctl/text.h"

#include <CLI/CLI.hpp>

#include <memory>

namespace evod::ctl {

namespace {

struct SetOptions {
    std::vector<std::string> words;
    bool dry_run = false;
    std::optional<std::uint64_t> expected_revision;
};

const v1::ParameterState* find(const v1::ParameterSet& parameters, const std::string& name) {
    for (const auto& parameter : parameters.parameters()) {
        if (parameter.name() == name) {
            return &parameter;
        }
    }
    return nullptr;
}

/// "mutation_chance=0.05", and what it will be where that differs.
std::string line_of(const v1::ParameterState& state, const Registry& registry) {
    std::string line = state.name() + "=" + to_text(state.value());
    if (state.has_pending()) {
        const auto* description = registry.find(state.name());
        const bool reset = description != nullptr && description->effect() == v1::PARAMETER_EFFECT_RESET;
        line += "  # " + to_text(state.pending()) + (reset ? " after a reset" : " from the next generation");
    }
    return line + "\n";
}

void set(const Common& common, const SetOptions& options) {
    Caller caller{common};
    const Registry registry = caller.registry();
    auto assignments = registry.assignments(options.words);
    if (!assignments) {
        stop_for("nothing was set:", assignments.error());
    }
    v1::Request request;
    auto& command = *request.mutable_set_parameters();
    command.set_world(common.world);
    command.set_dry_run(options.dry_run);
    if (options.expected_revision) {
        command.set_expected_revision(*options.expected_revision);
    }
    for (const auto& assignment : *assignments) {
        *command.add_parameters() = assignment;
    }
    const v1::Response response = caller.call(std::move(request));
    print(common, response, [&] {
        std::string text = options.dry_run ? "allowed; it would be:\n" : "";
        for (const auto& assignment : *assignments) {
            if (const auto* state = find(response.parameters(), assignment.name())) {
                text += line_of(*state, registry);
            }
        }
        if (!options.dry_run) {
            text += "from tick " + std::to_string(response.applied_tick()) + ", revision " +
                    std::to_string(response.parameters().revision()) + "\n";
        }
        return text;
    });
}

void get(const Common& common, const std::vector<std::string>& names) {
    Caller caller{common};
    const Registry registry = caller.registry();
    v1::Request request;
    request.mutable_get_parameters()->set_world(common.world);
    v1::ParameterSet parameters = caller.call(std::move(request)).parameters();
    if (!names.empty()) {
        v1::ParameterSet some;
        some.set_revision(parameters.revision());
        Mistakes mistakes;
        for (const std::string& name : names) {
            if (const auto* state = find(parameters, name)) {
                *some.add_parameters() = *state;
            } else {
                mistakes.lines.push_back(registry.unknown(name));
            }
        }
        if (!mistakes.lines.empty()) {
            stop_for("", mistakes);
        }
        parameters = std::move(some);
    }
    print(common, parameters, [&] {
        std::string text;
        for (const auto& state : parameters.parameters()) {
            text += line_of(state, registry);
        }
        return text;
    });
}

void describe_one(const Common& common, const Registry& registry, const std::string& name) {
    const auto* parameter = registry.find(name);
    if (parameter == nullptr) {
        throw Stop{ExitCode::Usage, registry.unknown(name)};
    }
    print(common, *parameter, [&] {
        const char* const kind = parameter->kind() == v1::PARAMETER_KIND_REAL    ? "a number"
                                 : parameter->kind() == v1::PARAMETER_KIND_COUNT ? "a whole number"
                                 : parameter->kind() == v1::PARAMETER_KIND_FLAG  ? "true or false"
                                                                                 : "a choice";
        return parameter->name() + ": " + kind + "\n  " + parameter->help() + "\n  allowed       " +
               allowed(*parameter) + "\n  default       " + to_text(parameter->default_value()) +
               (parameter->unit().empty() ? "" : "\n  unit          " + parameter->unit()) + "\n  takes effect  " +
               effect_of(*parameter) + "\n";
    });
}

void params(const Common& common, const std::string& name) {
    Caller caller{common};
    v1::Request request;
    request.mutable_describe();
    v1::Description description = caller.call(std::move(request)).description();
    const Registry registry{description};
    if (!name.empty()) {
        describe_one(common, registry, name);
        return;
    }
    description.clear_file_descriptor_set();
    description.clear_limits();
    print(common, description, [&] {
        Table table{{{"PARAMETER"}, {"DEFAULT", Table::Align::Right}, {"UNIT"}, {"TAKES EFFECT"}, {"ALLOWED"}}};
        for (const auto& parameter : registry.parameters()) {
            table.add({parameter.name(), to_text(parameter.default_value()), parameter.unit(), effect_of(parameter),
                       allowed(parameter)});
        }
        return table.to_text();
    });
}

} // namespace

void add_parameter_commands(CLI::App& app, const Common& common, Selected& selected) {
    const char* const group = "Parameters";
    auto* set_command = app.add_subcommand("set", "Change parameters: all that are given, or none")->group(group);
    auto options = std::make_shared<SetOptions>();
    set_command->add_option("NAME=VALUE", options->words, "Parameters with their new values")->required();
    set_command->add_flag("--dry-run", options->dry_run, "Only check; change nothing");
    set_command
        ->add_option("--if-revision", options->expected_revision,
                     "Refuse if anyone has changed a parameter since this revision")
        ->check(whole_number);
    set_command->footer("Examples:\n  evoctl set selection=tournament mutation_chance=0.05 mutate_survivors=true\n"
                        "  evoctl set --dry-run food_count=1e6\n"
                        "Names and ranges: evoctl params");
    set_command->callback([&, options] { selected = [&, options] { set(common, *options); }; });

    auto* get_command = app.add_subcommand("get", "The values of parameters, as `set` takes them")->group(group);
    auto names = std::make_shared<std::vector<std::string>>();
    get_command->add_option("NAME", *names, "Parameters; without any, all of them");
    get_command->footer("Examples:\n  evoctl get selection mutation_chance\n  evoctl get --json | jq .revision");
    get_command->callback([&, names] { selected = [&, names] { get(common, *names); }; });

    auto* params_command = app.add_subcommand("params", "Which parameters there are")->group(group);
    auto name = std::make_shared<std::string>();
    params_command->add_option("NAME", *name, "One parameter, with all that is known of it");
    params_command->callback([&, name] { selected = [&, name] { params(common, *name); }; });
}

} // namespace evod::ctl
