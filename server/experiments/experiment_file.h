// Experiment files on disk, and changes to them from the command line.
#pragma once

#include "server/parameters/experiment.h"

#include <string>
#include <vector>

namespace evod::experiments {

/// A file that people write, at most 1 MiB. kind  what it is to be: "an experiment file".
base::Result<std::string> load_text(const std::string& path, const std::string& kind);

/// Reads and validates a file; the refusal's message begins with the path.
base::Result<parameters::Experiment> load_experiment(const std::string& path);

/// The experiment with each "name=value" of `changes` made, which then is so in all generations; violations are named
/// by
/// "--set name".
base::Result<parameters::Experiment> with_changes(parameters::Experiment experiment,
                                                  const std::vector<std::string>& changes);

/// Whether what is scheduled goes together with parameters that were changed, with which it then begins; violations
/// name the generation.
base::Result<void> fit_schedule(parameters::Experiment& experiment);

/// A world's name for an experiment: the file's name without folder and ending, other characters than a-z A-Z 0-9 _ -
/// replaced by "_", at most 64.
std::string world_name(const std::string& path);

} // namespace evod::experiments
