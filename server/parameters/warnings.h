// Warnings: valid parameters with which nothing can evolve. The programs print them and still run the experiment,
// because a control may need such a setting.
//
// Threads      any; no state.
// Determinism  the texts depend only on the parameters.
#pragma once

#include "server/parameters/model_parameters.h"

#include <string>
#include <vector>

namespace evod::parameters {

/// Returns a sentence for each reason why the population cannot evolve, or begins without variety. Each sentence names
/// the parameters and their values. Empty if there is no reason.
std::vector<std::string> warnings_of(const Parameters& parameters);

} // namespace evod::parameters
