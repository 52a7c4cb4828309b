// Population files: the chromosomes of a generation as CSV, for another world to begin with.
//
//   island,organism,normal_speed,impulse,body_size,base_health,food_radius,poison_radius
//   0,0,103.2,97.5,…
//
// Islands and organisms count from 0, in order. A gene is the shortest text that reads back as the same float.
#pragma once

#include "server/base/result.h"
#include "server/simulation/first_population.h"

#include <istream>
#include <string>
#include <vector>

namespace evod::console {

/// Whether a world can begin so is left to faults_of(); the refusal's message begins with the line: "line 3: …".
base::Result<simulation::FirstPopulation> read_population(std::istream& in);

/// Reads a file for a world with these parameters; nullptr for an empty path. The refusal's message names the file.
base::Result<simulation::FirstPopulation> load_population(const std::string& path,
                                                          const simulation::Parameters& parameters);

} // namespace evod::console
