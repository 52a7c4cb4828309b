// Population files: CSV files with the chromosomes with which a world begins (proto/codec/population_csv.h).
#pragma once

#include "server/base/result.h"
#include "server/simulation/first_population.h"

#include <string>
#include <vector>

namespace evod::experiments {

/// Reads the files for a world with these parameters; the organisms of each island are those of all files, in order.
/// Returns nullptr if there is no path. The population may have fewer organisms than the world has places:
/// simulation::completed() fills them. A refusal names the file.
base::Result<simulation::FirstPopulation> load_population(const std::vector<std::string>& paths,
                                                          const parameters::Parameters& parameters);

} // namespace evod::experiments
