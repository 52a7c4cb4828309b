// Experiment files on disk, and changes to them from the command line.
#pragma once

#include "server/simulation/experiment.h"

#include <string>
#include <vector>

namespace evod::console {

/// Reads and validates a file; the refusal's message begins with the path.
base::Result<simulation::Experiment> load_experiment(const std::string& path);

/// `parameters` with each "name=value" of `changes` made; violations are named by "--set name".
base::Result<simulation::Parameters> with_changes(const simulation::Parameters& parameters,
                                                  const std::vector<std::string>& changes);

/// A world's name for an experiment: the file's name without folder and ending, other characters than a-z A-Z 0-9 _ -
/// replaced by "_", at most 64.
std::string world_name(const std::string& path);

} // namespace evod::console
