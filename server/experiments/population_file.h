// Population files: the chromosomes of a generation (proto/codec/population_csv.h), for another world to begin with.
#pragma once

#include "server/base/result.h"
#include "server/simulation/first_population.h"

#include <string>

namespace evod::experiments {

/// Reads a file for a world with these parameters; nullptr for an empty path. The refusal's message names the file.
base::Result<simulation::FirstPopulation> load_population(const std::string& path,
                                                          const parameters::Parameters& parameters);

} // namespace evod::experiments
