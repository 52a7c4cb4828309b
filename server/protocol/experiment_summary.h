// Experiment summary: the sentences that explain to a newcomer what the organisms of a world try to do. The clients
// print them.
//
// Threads      any.
#pragma once

#include "server/parameters/model_parameters.h"

#include <string>

namespace evod::protocol {

/// Returns sentences about the parameters in effect: "50 organisms seek food (+25 health) and avoid poison (−40). …".
std::string experiment_summary(const parameters::Parameters& parameters);

} // namespace evod::protocol
