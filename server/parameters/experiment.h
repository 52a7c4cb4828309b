// Experiment files: a JSON object of parameters by their registry names, with optional "seed" and "description".
//
// A parameter that can change while a world runs may have an object of values instead of one, by the generation from
// whose first tick on each holds: "mutation_chance": {"1": 0.2, "30": 0.05}. Until the first of them it has its
// default.
#pragma once

#include "server/base/random.h"
#include "server/base/result.h"
#include "server/parameters/parameters.h"
#include "server/parameters/schedule.h"

#include <optional>
#include <string>
#include <string_view>

namespace evod::parameters {

struct Experiment {
    Parameters parameters; // of generation 1
    Schedule schedule;     // in which faults_of() finds nothing
    std::optional<base::Seed> seed;
    std::string description;
};

/// Reads the text of an experiment file; what it does not name has its default, but reference_population, which follows
/// population_size, the first if that changes. Violations name the field with its line: "mutation_chance (line 4)",
/// "mutation_chance at generation 30 (line 4)".
base::Result<Experiment> parse_experiment(std::string_view text);

enum class Written { Differences, Everything }; // from the defaults
/// The parameters as an experiment file, one a line, in registry order; those that are scheduled as their schedule has
/// them.
std::string to_experiment_text(const Parameters& parameters, Written written = Written::Differences,
                               const Schedule& schedule = {});

/// A schedule alone, as an experiment file has it; "{}\n" for none.
std::string to_schedule_text(const Schedule& schedule);
/// Takes nothing else than to_schedule_text() writes. Whether the values go together, the run's parameters decide.
base::Result<Schedule> parse_schedule(std::string_view text);

} // namespace evod::parameters
