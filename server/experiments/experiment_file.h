// Experiment files: reads them, and makes the changes of `--set`.
#pragma once

#include "server/parameters/experiment.h"

#include <string>
#include <vector>

namespace evod::experiments {

/// The text of a file, at most 1 MiB.
///
/// kind  what the file should be, for errors: "an experiment file".
base::Result<std::string> load_text(const std::string& path, const std::string& kind);

/// Reads and validates a file. The refusal's message begins with the path.
base::Result<parameters::Experiment> load_experiment(const std::string& path);

/// Makes each change "name=value", for all generations: it removes the parameter from the schedule. Violations are
/// named "--set name".
base::Result<parameters::Experiment> with_changes(parameters::Experiment experiment,
                                                  const std::vector<std::string>& changes);

/// Makes the schedule begin with the parameters of the experiment, and validates each of its generations. Violations
/// name the generation.
base::Result<void> fit_schedule(parameters::Experiment& experiment);

/// The name of the world of an experiment: the name of the file without folder and extension, at most 64 characters;
/// those other than a-z A-Z 0-9 _ - become "_".
std::string world_name(const std::string& path);

} // namespace evod::experiments
