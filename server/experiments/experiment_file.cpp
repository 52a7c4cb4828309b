#include "server/experiments/experiment_file.h"

#include "server/files/regular_file.h"
#include "server/simulation/world_name.h"

#include <algorithm>
#include <filesystem>

namespace evod::experiments {
base::Result<std::string> load_text(const std::string& path, const std::string& kind) {
    auto text = files::read_file(path, kind, files::experiment_bytes_max);
    if (text && text->starts_with("\xef\xbb\xbf")) { // a byte order mark, which editors may write
        text->erase(0, 3);
    }
    return text;
}

base::Result<parameters::Experiment> load_experiment(const std::string& path) {
    const base::Result<std::string> text = load_text(path, "an experiment file");
    if (!text) {
        return text.error();
    }
    base::Result<parameters::Experiment> experiment = parameters::parse_experiment(*text);
    if (!experiment) {
        base::Refusal named = experiment.error();
        named.message = path + ": " + named.message;
        return named;
    }
    return experiment;
}

base::Result<parameters::Experiment> with_changes(parameters::Experiment experiment,
                                                  const std::vector<std::string>& changes) {
    std::vector<parameters::Assignment> assignments;
    std::vector<base::Violation> violations;
    for (const std::string& change : changes) {
        const std::size_t equals = change.find('=');
        if (equals == std::string::npos) {
            violations.push_back({"--set", "name=value", change});
            continue;
        }
        const std::string name = change.substr(0, equals), text = change.substr(equals + 1);
        const parameters::ParameterDescription* description = parameters::find_parameter(name);
        if (description == nullptr) {
            assignments.push_back({name, text}); // assign() rejects the unknown name
            continue;
        }
        base::Result<parameters::ParameterValue> value = parameters::parse_value(*description, text);
        if (value) {
            assignments.push_back({name, std::move(*value)});
        } else {
            const base::Refusal refused = value.error();
            violations.push_back({"--set " + name, refused.violations[0].allowed, refused.violations[0].got});
        }
    }
    base::Result<parameters::Parameters> changed = parameters::assign(experiment.parameters, assignments, "--set ");
    if (!changed) {
        const base::Refusal refused = changed.error();
        violations.insert(violations.end(), refused.violations.begin(), refused.violations.end());
    }
    if (!violations.empty()) {
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = "invalid parameter values",
                             .violations = std::move(violations)};
    }
    experiment.parameters = *changed;
    for (const parameters::Assignment& assignment : assignments) {
        experiment.schedule.remove(assignment.name);
    }
    return experiment;
}

base::Result<void> match_schedule_to_parameters(parameters::Experiment& experiment) {
    experiment.schedule.begin_with(experiment.parameters);
    const auto faults = faults_of(experiment.schedule, experiment.parameters);
    if (faults.empty()) {
        return {};
    }
    base::Refusal refused{.code = base::RefusalCode::InvalidArgument,
                          .message = "the schedule does not fit the parameters that were set",
                          .violations = {}};
    for (const parameters::ScheduleFault& fault : faults) {
        refused.violations.push_back({fault.violation.field + " at generation " + std::to_string(fault.generation),
                                      fault.violation.allowed, fault.violation.got});
    }
    return refused;
}

std::optional<base::Violation> fault_without_network(const parameters::Parameters& parameters) {
    if (parameters.fitness != parameters::FitnessFunction::External) {
        return std::nullopt;
    }
    return base::Violation{"fitness",
                           "life, gene_sum or rastrigin: no client can send fitness to this command; start a server "
                           "with `evod --experiment`",
                           "external"};
}

std::string world_name(const std::string& path) {
    std::string name = std::filesystem::path{path}.stem().string().substr(0, simulation::world_name_bytes_max);
    for (char& c : name) {
        if (!simulation::is_world_name_character(c)) {
            c = '_';
        }
    }
    return name.empty() ? "default" : name;
}

} // namespace evod::experiments
