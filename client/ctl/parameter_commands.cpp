// Commands for parameters: set, changes, cancel, get, params.
#include "client/core/actor.h"
#include "client/ctl/caller.h"
#include "client/ctl/text.h"
#include "proto/command_line/command.h"

#include <algorithm>

namespace evod::ctl {

namespace {

struct SetOptions {
    std::vector<std::string> words;
    bool dry_run = false;
    std::optional<std::uint64_t> expected_revision;
    std::optional<std::uint64_t> at_generation, at_tick;
};

/// Formats a planned change: "change 3, from generation 30: mutation_chance=0.05, by evoctl 127.0.0.1:5".
std::string line_of(const v1::PlannedChange& change) {
    std::string text =
        (change.id() == 0 ? "a change" : "change " + std::to_string(change.id())) +
        (change.at_case() == v1::PlannedChange::kTick ? ", after tick " + std::to_string(change.tick())
                                                      : ", from generation " + std::to_string(change.generation())) +
        ":";
    for (const auto& assignment : change.parameters()) {
        text += " " + assignment.name() + "=" + to_text(assignment.value());
    }
    return text + (change.has_by() ? ", by " + core::to_text(change.by()) : "");
}

const v1::ParameterState* find(const v1::ParameterSet& parameters, const std::string& name) {
    for (const auto& parameter : parameters.parameters()) {
        if (parameter.name() == name) {
            return &parameter;
        }
    }
    return nullptr;
}

/// Returns when a value that waits takes effect: "after the next reset".
std::string start_of_pending(const v1::ParameterState& state, const Registry& registry) {
    const auto* description = registry.find(state.name());
    const auto effect = state.has_effect()       ? state.effect()
                        : description == nullptr ? v1::PARAMETER_EFFECT_NEXT_GENERATION
                                                 : description->effect();
    return effect == v1::PARAMETER_EFFECT_RESET       ? "after the next reset"
           : effect == v1::PARAMETER_EFFECT_NEXT_TICK ? "from the next tick"
                                                      : "from the next generation";
}

/// Formats what `set` has done: "mutation_chance=0.05", or "fitness: gene_sum after the next reset (now life)".
std::string changed_line_of(const v1::ParameterState& state, const Registry& registry) {
    return state.has_pending() ? state.name() + ": " + to_text(state.pending()) + " " +
                                     start_of_pending(state, registry) + " (now " + to_text(state.value()) + ")\n"
                               : state.name() + "=" + to_text(state.value()) + "\n";
}

/// Formats the value of a parameter: "mutation_chance=0.05", followed by its pending and scheduled values, as
/// `get` prints it.
std::string line_of(const v1::ParameterState& state, const Registry& registry, const v1::ParameterSet& set) {
    std::string coming;
    if (state.has_pending()) {
        coming = to_text(state.pending()) + " " + start_of_pending(state, registry);
    }
    for (const auto& scheduled : set.schedule()) {
        if (scheduled.name() == state.name()) {
            coming += (coming.empty() ? "" : ", ") + to_text(scheduled.value()) + " from generation " +
                      std::to_string(scheduled.generation());
        }
    }
    return state.name() + "=" + to_text(state.value()) + (coming.empty() ? "" : "  # " + coming) + "\n";
}

void set(const Common& common, const SetOptions& options) {
    Caller caller{common};
    const Registry registry = caller.registry();
    auto assignments = registry.assignments(options.words);
    if (!assignments) {
        stop_for(assignments.error());
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
    if (options.at_generation || options.at_tick) {
        caller.need("planned_changes", "plan changes of parameters");
    }
    if (options.at_generation) {
        command.set_at_generation(*options.at_generation);
    }
    if (options.at_tick) {
        command.set_at_tick(*options.at_tick);
    }
    const v1::Response response = caller.call(std::move(request));
    print(common, response, [&] {
        if (response.has_planned_change()) {
            return (options.dry_run ? "allowed; it would be planned: " : "planned: ") +
                   line_of(response.planned_change()) + "\n";
        }
        std::string text = options.dry_run ? "allowed; it would be:\n" : "";
        for (const auto& assignment : *assignments) {
            if (const auto* state = find(response.parameters(), assignment.name())) {
                text += changed_line_of(*state, registry);
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
                for (const auto& scheduled : parameters.schedule()) {
                    if (scheduled.name() == name) {
                        *some.add_schedule() = scheduled;
                    }
                }
            } else {
                mistakes.lines.push_back(registry.unknown(name));
            }
        }
        if (!mistakes.lines.empty()) {
            stop_for(mistakes);
        }
        parameters = std::move(some);
    }
    print(common, parameters, [&] {
        std::string text;
        for (const auto& state : parameters.parameters()) {
            text += line_of(state, registry, parameters);
        }
        return text;
    });
}

void changes(const Common& common) {
    Caller caller{common};
    v1::Request request;
    request.mutable_get_parameters()->set_world(common.world);
    v1::ParameterSet parameters = caller.call(std::move(request)).parameters();
    parameters.clear_parameters();
    print(common, parameters, [&] {
        std::string text;
        for (int i = 0; i < parameters.schedule_size();) {
            const std::uint64_t generation = parameters.schedule(i).generation();
            text += "the schedule, from generation " + std::to_string(generation) + ":";
            for (; i < parameters.schedule_size() && parameters.schedule(i).generation() == generation; ++i) {
                text += " " + parameters.schedule(i).name() + "=" + to_text(parameters.schedule(i).value());
            }
            text += "\n";
        }
        for (const auto& change : parameters.planned()) {
            text += line_of(change) + "\n";
        }
        return text.empty() ? std::string{"nothing is planned\n"} : text;
    });
}

void cancel(const Common& common, std::uint64_t id) {
    Caller caller{common};
    caller.need("planned_changes", "plan changes of parameters");
    v1::Request request;
    request.mutable_cancel_change()->set_world(common.world);
    request.mutable_cancel_change()->set_id(id);
    const v1::Response response = caller.call(std::move(request));
    print(common, response, [&] { return "cancelled: " + line_of(response.planned_change()) + "\n"; });
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
        std::string choices;
        for (int i = 0; i < std::min(parameter->choices_size(), parameter->choice_help_size()); ++i) {
            choices += "\n  " + parameter->choices(i) + ": " + parameter->choice_help(i);
        }
        return parameter->name() + ": " + kind + "\n  " + parameter->help() + "\n  allowed       " +
               allowed(*parameter) + "\n  default       " + to_text(parameter->default_value()) +
               (parameter->unit().empty() ? "" : "\n  unit          " + parameter->unit()) + "\n  takes effect  " +
               effect_of(*parameter) + choices + "\n";
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

void add_parameter_commands(command_line::Command& app, const Common& common) {
    const char* const group = "Parameters";
    auto& set_command =
        app.add_command("set", "Change parameters; if one value is refused, none is changed").group(group);
    auto& options = set_command.keep(SetOptions{});
    set_command.add_option("CHANGE", &options.words, "Parameters with their new values, each as NAME=VALUE").required();
    set_command.add_flag("--dry-run", &options.dry_run, "Only check the values; change nothing");
    set_command
        .add_option("--if-revision", &options.expected_revision,
                    "Refuse if a parameter was changed after this revision")
        .check(whole_number);
    const auto at_generation = set_command
                                   .add_option("--at-generation", &options.at_generation,
                                               "Apply at the first tick of this generation, not now")
                                   .check(whole_number);
    set_command.add_option("--at-tick", &options.at_tick, "Apply after this tick of the run, not now")
        .check(whole_number)
        .excludes(at_generation);
    set_command.footer("Examples:\n  evoctl set selection=tournament mutation_chance=0.05 mutate_survivors=true\n"
                       "  evoctl set --dry-run food_count=1e6\n"
                       "  evoctl set --at-generation 30 mutation_chance=0.01\n"
                       "Names and ranges: evoctl params");
    set_command.action([&] { set(common, options); });

    app.add_command("changes", "List planned changes").group(group).action([&] { changes(common); });

    auto& cancel_command = app.add_command("cancel", "Cancel a planned change").group(group);
    auto& id = cancel_command.keep(std::uint64_t{0});
    cancel_command.add_option("ID", &id, "Number of the change, printed by `evoctl changes`")
        .required()
        .check(whole_number);
    cancel_command.action([&] { cancel(common, id); });

    auto& get_command = app.add_command("get", "Print values of parameters in the format of `set`").group(group);
    auto& names = get_command.keep(std::vector<std::string>{});
    get_command.add_option("NAME", &names, "Parameters; default: all");
    get_command.footer("Examples:\n  evoctl get selection mutation_chance\n  evoctl get --json | jq .revision");
    get_command.action([&] { get(common, names); });

    auto& params_command = app.add_command("params", "List all parameters, or describe one parameter").group(group);
    auto& name = params_command.keep(std::string{});
    params_command.add_option("NAME", &name, "Name of a parameter to describe; default: list all parameters");
    params_command.action([&] { params(common, name); });
}

} // namespace evod::ctl
