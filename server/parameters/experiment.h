// Experiment files: a JSON object of parameters by their registry names, with optional "seed" and "description".
//
// A parameter that can change while a world runs may have an object of values by generation instead of one value:
// "mutation_chance": {"1": 0.2, "30": 0.05}. Each value holds from the first tick of its generation. Before the first
// listed generation the parameter has its default value.
//
// "free_genes" is a number, or a list of genes (gene_list.h).
#pragma once

#include "server/base/random.h"
#include "server/base/result.h"
#include "server/parameters/json_text.h"
#include "server/parameters/model_parameters.h"
#include "server/parameters/schedule.h"

#include <optional>
#include <string>
#include <string_view>

namespace evod::parameters {

struct Experiment {
    Parameters parameters; // of generation 1
    Schedule schedule;     // without faults (faults_of())
    std::optional<base::Seed> seed;
    std::string description;
};

/// Reads the text of an experiment file. A parameter that the text does not name has its default value, except
/// followers(), which then equal what they follow in generation 1. Violations name the field with its line:
/// "mutation_chance (line 4)", "mutation_chance at generation 30 (line 4)".
base::Result<Experiment> parse_experiment(std::string_view text);
/// Reads an experiment from a JSON value inside another file. Violations name the lines of that file.
base::Result<Experiment> read_experiment(const JsonNode& document);

/// Converts a JSON value to a parameter value. A number without a fraction becomes a count if it fits. Returns nullopt
/// for null, arrays and objects.
std::optional<ParameterValue> parameter_value_of(const JsonNode& node);

enum class Written { Differences, Everything }; // Differences: only the parameters that differ from their defaults
/// Returns the parameters as an experiment file, one per line, in registry order. Scheduled parameters are written with
/// the values of the schedule.
std::string to_experiment_text(const Parameters& parameters, Written written = Written::Differences,
                               const Schedule& schedule = {});

/// Returns the schedule alone, in the form of an experiment file; "{}\n" if the schedule is empty.
std::string to_schedule_text(const Schedule& schedule);
/// Reads the output of to_schedule_text(). Does not check whether the values fit the parameters of the run.
base::Result<Schedule> parse_schedule(std::string_view text);

} // namespace evod::parameters
