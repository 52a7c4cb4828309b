// Population files: CSV files with the chromosomes with which a world begins (proto/codec/population_csv.h).
#pragma once

#include "server/base/result.h"
#include "server/simulation/first_population.h"

#include <string>

namespace evod::experiments {

/// Reads a file for a world with these parameters. Returns nullptr if `path` is empty. A refusal names the file.
base::Result<simulation::FirstPopulation> load_population(const std::string& path,
                                                          const parameters::Parameters& parameters);

} // namespace evod::experiments
