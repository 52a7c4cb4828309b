// Experiment files: reads them and applies the changes of `--set`.
#pragma once

#include "server/parameters/experiment.h"

#include <optional>
#include <string>
#include <vector>

namespace evod::experiments {

/// Reads the text of a file of at most 1 MiB.
///
/// kind  the expected kind of file, for error messages: "an experiment file".
base::Result<std::string> load_text(const std::string& path, const std::string& kind);

/// Reads and validates an experiment file. The message of a refusal begins with the path.
base::Result<parameters::Experiment> load_experiment(const std::string& path);

/// Applies each change "name=value" to all generations, so it also removes the parameter from the schedule. A violation
/// has the name "--set name".
base::Result<parameters::Experiment> with_changes(parameters::Experiment experiment,
                                                  const std::vector<std::string>& changes);

/// Makes the first values of the schedule equal to the parameters of the experiment, and validates every generation of
/// the schedule. Violations name the generation.
base::Result<void> match_schedule_to_parameters(parameters::Experiment& experiment);

/// Returns why a command without a network cannot run a world with these parameters: it needs fitness from clients.
/// Returns nullopt if the command can run it.
std::optional<base::Violation> fault_without_network(const parameters::Parameters& parameters);

/// Derives the name of an experiment's world from the name of its file, without folder and extension. It has at most 64
/// characters. Each character other than a-z A-Z 0-9 _ - becomes "_".
std::string world_name(const std::string& path);

} // namespace evod::experiments
