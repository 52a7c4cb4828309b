#include "server/experiments/sweep_file.h"

#include "proto/text/suggestion.h"
#include "server/experiments/experiment_file.h"
#include "server/experiments/sweep_design.h"
#include "server/experiments/trials.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

namespace evod::experiments {
namespace {

using base::Violation;
using parameters::JsonMember;
using parameters::JsonNode;
using parameters::ParameterDescription;
using parameters::Parameters;

bool has_termination_criterion(const Parameters& parameters) {
    return parameters.generation_limit > 0 || parameters.stagnation_limit > 0 || parameters.stop_at_target_fitness ||
           parameters.stop_at_extinction;
}

/// The members of the file, before the experiment and the design have been read.
struct SweepMembers {
    const JsonMember* experiment = nullptr;
    std::vector<const JsonMember*> designs;
    std::optional<std::uint32_t> generations, replicates;
    std::optional<std::uint64_t> seed;
    std::optional<std::uint32_t> every;
    const JsonMember* seeds = nullptr;
    bool skip_invalid = false;
};

template <class Number>
void read_whole_number(const JsonMember& member, std::uint64_t least, std::uint64_t greatest,
                       std::optional<Number>& number, SweepErrors& errors) {
    const auto given = member.value.whole_number();
    if (given && *given >= least && *given <= greatest) {
        number = static_cast<Number>(*given);
    } else {
        errors.add(member.name, member.value,
                   "a whole number, " + std::to_string(least) + " to " + std::to_string(greatest));
    }
}

/// Returns the members that are allowed instead of an unknown one, and which of them the author may have meant.
std::string members_instead_of(const std::string& name) {
    static constexpr std::string_view members[] = {"description",     "experiment", "grid",        "list",
                                                   "latin_hypercube", "replicates", "seed",        "seeds",
                                                   "generations",     "every",      "skip_invalid"};
    std::string allowed, meant;
    for (const std::string_view member : members) {
        allowed += (allowed.empty() ? "" : ", ") + std::string{member};
    }
    if (name == "parameters") {
        meant = "grid";
    } else if (parameters::find_parameter(name) != nullptr) {
        meant = "grid." + name;
    }
    for (const std::string& member : text::nearest(name, members)) {
        meant += (meant.empty() ? "" : ", ") + member;
    }
    return allowed + (meant.empty() ? "" : "; did you mean " + meant);
}

SweepMembers read_members(const JsonNode& document, SweepErrors& errors) {
    SweepMembers members;
    for (const JsonMember* member : parameters::unique_members(document, "", errors.violations)) {
        const std::string& name = member->name;
        if (name == "experiment") {
            members.experiment = member;
        } else if (name == "grid" || name == "list" || name == "latin_hypercube") {
            members.designs.push_back(member);
        } else if (name == "replicates") {
            read_whole_number(*member, 1, Sweep::runs_max, members.replicates, errors);
        } else if (name == "generations") {
            read_whole_number(*member, 1, base::count_max, members.generations, errors);
        } else if (name == "seed") {
            if (member->value.is_array()) {
                errors.add(name, member->value, "one whole number; the member \"seeds\" gives each replicate its seed");
                continue;
            }
            read_whole_number(*member, 0, ~std::uint64_t{0}, members.seed, errors);
        } else if (name == "seeds") {
            members.seeds = member;
        } else if (name == "every") {
            read_whole_number(*member, 1, base::count_max, members.every, errors);
        } else if (name == "skip_invalid") {
            members.skip_invalid = member->value.text == "true";
            if (!members.skip_invalid && member->value.text != "false") {
                errors.add(name, member->value, "true or false");
            }
        } else if (name != "description") {
            errors.add(parameters::with_line(name, member->line), members_instead_of(name), base::unknown_name);
        } else if (!member->value.is_string()) {
            errors.add(name, member->value, "a text");
        }
    }
    if (members.designs.size() != 1) {
        std::string got;
        for (const JsonMember* design : members.designs) {
            got += (got.empty() ? "" : " and ") + design->name;
        }
        errors.add(got.empty() ? "grid"
                               : parameters::with_line(members.designs.back()->name, members.designs.back()->line),
                   "one of grid, list, latin_hypercube", got.empty() ? "none of them" : got);
    }
    return members;
}

/// Reads the seeds of the replicates, which also determine the number of replicates.
void read_seeds(const SweepMembers& members, Sweep& sweep, SweepErrors& errors) {
    const JsonNode& list = members.seeds->value;
    if (!list.is_array() || list.elements.empty() || list.elements.size() > Sweep::runs_max) {
        return errors.add("seeds", list, "a list of seeds, one for each replicate: [11, 12]");
    }
    for (const JsonNode& element : list.elements) {
        const auto seed = element.whole_number();
        if (!seed) {
            errors.add("seeds", element, "whole numbers, 0 to " + std::to_string(~std::uint64_t{0}));
        } else if (std::ranges::find(sweep.seeds, base::Seed{*seed}) != sweep.seeds.end()) {
            errors.add("seeds", element, "each seed once");
        } else {
            sweep.seeds.push_back({*seed});
        }
    }
    if (members.replicates && *members.replicates != list.elements.size()) {
        errors.add("replicates", "no value, or " + std::to_string(list.elements.size()) + ", the number of seeds",
                   std::to_string(*members.replicates));
    }
    sweep.replicates = static_cast<std::uint32_t>(list.elements.size());
}

/// Adds the experiment to the sweep, or its errors with `prefix` before each field name.
void take_experiment(const base::Result<parameters::Experiment>& experiment, const std::string& prefix, Sweep& sweep,
                     SweepErrors& errors) {
    if (experiment) {
        sweep.parameters = experiment->parameters;
        sweep.schedule = experiment->schedule;
        sweep.seed = experiment->seed.value_or(sweep.seed);
        return;
    }
    const base::Refusal refused = experiment.error();
    for (const Violation& violation : refused.violations) {
        errors.add(prefix + violation.field, violation.allowed, violation.got);
    }
}

void read_experiment_member(const JsonNode& node, const LoadExperiment& load, Sweep& sweep, SweepErrors& errors) {
    if (node.is_object()) {
        take_experiment(parameters::read_experiment(node), "experiment.", sweep, errors);
    } else if (node.is_string()) {
        const std::string path = node.string();
        const auto loaded = load(path);
        if (!loaded && loaded.error().violations.empty()) {
            errors.add("experiment", node, "the path of an experiment file: " + loaded.error().message);
        } else {
            take_experiment(loaded, "experiment " + path + ": ", sweep, errors);
        }
    } else {
        errors.add("experiment", node, "the path of an experiment file, or an object of parameters");
    }
}

/// The beginning of an error about a cell: "cell 3 (food_count 5): ".
std::string cell_prefix(const Sweep& sweep, std::size_t cell) {
    std::string name = "cell " + std::to_string(cell);
    for (std::size_t i = 0; i < sweep.swept.size(); ++i) {
        name += (i == 0 ? " (" : ", ") + std::string{sweep.swept[i]->name} + " " +
                parameters::to_text(sweep.cells[cell][i]);
    }
    return name + (sweep.swept.empty() ? ": " : "): ");
}

/// Reports cells whose runs would never end, because they have no termination criterion.
void check_ends(const Sweep& sweep, SweepErrors& errors) {
    std::vector<std::size_t> endless;
    for (std::size_t cell = 0; cell < sweep.cells.size(); ++cell) {
        if (!has_termination_criterion(sweep.parameters_of(cell))) {
            endless.push_back(cell);
        }
    }
    const std::string allowed = "a criterion that ends a run: generations, or one of the parameters generation_limit, "
                                "stagnation_limit, stop_at_target_fitness, stop_at_extinction";
    if (endless.size() == sweep.cells.size()) {
        return errors.add("generations", allowed, "nothing");
    }
    for (const std::size_t cell : endless) {
        errors.add(cell_prefix(sweep, cell) + "generation_limit", allowed, "nothing");
    }
}

/// Checks that the values of a cell are consistent with each other and with the schedule.
void check_cell(const Sweep& sweep, std::size_t cell, SweepErrors& errors) {
    const Parameters parameters = sweep.parameters_of(cell);
    auto faults = parameters::validate(parameters);
    if (auto fault = fault_without_network(parameters)) {
        faults.push_back(*std::move(fault));
    }
    for (const Violation& fault : faults) {
        errors.add(cell_prefix(sweep, cell) + fault.field, fault.allowed, fault.got);
    }
    if (!faults.empty()) {
        return;
    }
    for (const auto& [generation, fault] : parameters::faults_of(sweep.schedule_of(cell), parameters)) {
        errors.add(cell_prefix(sweep, cell) + fault.field + " at generation " + std::to_string(generation),
                   fault.allowed, fault.got);
    }
}

void check_cells(const Sweep& sweep, SweepErrors& errors) {
    for (std::size_t cell = 0; cell < sweep.cells.size(); ++cell) {
        check_cell(sweep, cell, errors);
    }
    check_ends(sweep, errors);
}

/// Leaves out the cells whose values are impossible together, unless all of them are. The other cells are numbered
/// from 0 again.
void skip_invalid_cells(Sweep& sweep) {
    std::vector<std::vector<parameters::ParameterValue>> valid;
    for (std::size_t cell = 0; cell < sweep.cells.size(); ++cell) {
        SweepErrors errors;
        check_cell(sweep, cell, errors);
        if (errors.violations.empty()) {
            valid.push_back(sweep.cells[cell]);
        } else {
            sweep.skipped.push_back(base::to_text(errors.violations.front()));
        }
    }
    if (!valid.empty()) {
        sweep.cells = std::move(valid);
    }
}

Sweep read_sweep(const JsonNode& document, const LoadExperiment& load, SweepErrors& errors) {
    const SweepMembers members = read_members(document, errors);
    Sweep sweep;
    sweep.replicates = members.replicates.value_or(1);
    sweep.every = members.every.value_or(1);
    if (members.seeds != nullptr) {
        read_seeds(members, sweep, errors);
    }
    if (members.experiment != nullptr) {
        read_experiment_member(members.experiment->value, load, sweep, errors);
    }
    if (members.generations) {
        sweep.parameters.generation_limit = *members.generations;
        sweep.schedule.remove("generation_limit");
    }
    if (members.seed) {
        sweep.seed = {*members.seed};
    }
    if (members.designs.size() == 1) {
        read_design(*members.designs.front(), sweep, errors);
        if (members.generations &&
            std::ranges::any_of(sweep.swept, [](auto* p) { return p->name == "generation_limit"; })) {
            errors.add("generations", "no value if generation_limit is swept", std::to_string(*members.generations));
        }
    }
    if (errors.violations.empty()) {
        for (const ParameterDescription* parameter : sweep.swept) {
            sweep.schedule.remove(parameter->name); // the value in the cell applies to all generations
        }
        if (members.skip_invalid) {
            skip_invalid_cells(sweep);
        }
        check_cells(sweep, errors);
    }
    return sweep;
}

base::Refusal refusal_of(std::vector<Violation> violations) {
    std::string message = "invalid sweep";
    if (const std::size_t count = violations.size(); count > violations_max) {
        message += ": " + std::to_string(count) + " errors; the first " + std::to_string(violations_max) + " are";
        violations.resize(violations_max);
    }
    return {
        .code = base::RefusalCode::InvalidArgument, .message = std::move(message), .violations = std::move(violations)};
}

} // namespace

base::Seed Sweep::seed_of(std::uint32_t replicate) const {
    return seeds.empty() ? replicate_seed(seed, replicate) : seeds[replicate];
}

Parameters Sweep::parameters_of(std::size_t cell) const {
    Parameters of_cell = parameters;
    for (std::size_t i = 0; i < swept.size(); ++i) {
        set_parameter(*swept[i], cells[cell][i], of_cell);
    }
    return of_cell;
}

parameters::Schedule Sweep::schedule_of(std::size_t cell) const {
    parameters::Schedule of_cell = schedule;
    of_cell.begin_with(parameters_of(cell));
    return of_cell;
}

base::Result<Sweep> parse_sweep(std::string_view text, const LoadExperiment& load) {
    const auto document = parameters::parse_json(text);
    if (!document) {
        return document.error();
    }
    if (!document->is_object()) {
        return refusal(base::RefusalCode::InvalidArgument, "not a sweep: expected a JSON object");
    }
    SweepErrors errors;
    Sweep sweep = read_sweep(*document, load, errors);
    if (!errors.violations.empty()) {
        return refusal_of(std::move(errors.violations));
    }
    sweep.text = text;
    return sweep;
}

base::Result<Sweep> load_sweep(const std::string& path) {
    const base::Result<std::string> text = load_text(path, "a sweep file");
    if (!text) {
        return text.error();
    }
    base::Result<Sweep> sweep = parse_sweep(*text, [&](const std::string& experiment) {
        return load_experiment((std::filesystem::path{path}.parent_path() / experiment).string());
    });
    if (!sweep) {
        base::Refusal named = sweep.error();
        named.message = path + ": " + named.message;
        return named;
    }
    return sweep;
}

} // namespace evod::experiments
