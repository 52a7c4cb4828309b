#include "server/protocol/experiments.h"

#include "server/protocol/gene_list.h"
#include "server/protocol/parameters.h"

#include <string>
#include <utility>

namespace evod::protocol {
namespace {

using base::Violation;
using Violations = std::vector<Violation>;

const std::string prefix = "create_world.";

void append(Violations& violations, const base::Refusal& refused, const std::string& field_prefix) {
    for (const Violation& violation : refused.violations) {
        violations.push_back({field_prefix + violation.field, violation.allowed, violation.got});
    }
}

/// Reads the experiment in the file's text. If it is invalid, adds violations and returns the default experiment.
parameters::Experiment experiment_of_file(const v1::CreateWorld& request, Violations& violations) {
    const std::string field = prefix + "experiment_json";
    if (request.schedule_size() > 0) {
        violations.push_back({prefix + "schedule", "empty if experiment_json is set",
                              std::to_string(request.schedule_size()) + " values"});
    }
    auto experiment = parameters::parse_experiment(request.experiment_json());
    if (experiment) {
        return *std::move(experiment);
    }
    const base::Refusal refused = experiment.error();
    if (refused.violations.empty()) {
        violations.push_back({field, "the text of an experiment file", refused.message});
    }
    append(violations, refused, field + ".");
    return {};
}

/// Changes parameters of an experiment for all generations.
void change(parameters::Experiment& experiment, const std::vector<parameters::Assignment>& changes,
            Violations& violations) {
    const auto changed = parameters::assign(experiment.parameters, changes, prefix);
    if (!changed) {
        return append(violations, changed.error(), "");
    }
    experiment.parameters = *changed;
    for (const parameters::Assignment& assignment : changes) {
        experiment.schedule.remove(assignment.name);
    }
    experiment.schedule.begin_with(experiment.parameters);
    for (const parameters::ScheduleFault& fault : faults_of(experiment.schedule, experiment.parameters)) {
        violations.push_back({prefix + fault.violation.field + " at generation " + std::to_string(fault.generation),
                              fault.violation.allowed, fault.violation.got});
    }
}

} // namespace

parameters::Experiment experiment_of(const v1::CreateWorld& request, Violations& violations) {
    Violations found;
    parameters::Experiment experiment;
    if (!request.experiment_json().empty()) {
        experiment = experiment_of_file(request, found);
    }
    const auto assignments = to_assignments(request.parameters(), prefix, found);
    if (request.has_free_genes()) {
        experiment.parameters.listed_genes =
            to_gene_list(request.free_genes(), std::string{prefix} + "free_genes", found);
        experiment.parameters.free_genes = experiment.parameters.listed_genes.gene_count();
    }
    if (found.empty()) {
        change(experiment, assignments, found);
    }
    if (found.empty() && request.experiment_json().empty()) {
        experiment.schedule = to_schedule(request.schedule(), experiment.parameters, prefix, found);
    }
    violations.insert(violations.end(), found.begin(), found.end());
    return experiment;
}

} // namespace evod::protocol
