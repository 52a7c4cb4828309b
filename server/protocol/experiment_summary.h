// Experiment summary: the sentences that explain to a newcomer what the organisms of a world try to do. The clients
// print them.
//
// Threads      any.
#pragma once

#include "server/parameters/model_parameters.h"
#include "server/parameters/schedule.h"

#include <cstdint>
#include <string>

namespace evod::protocol {

/// Returns sentences about the parameters in effect: "50 organisms seek food (+25 health) and avoid poison (−40). …".
std::string experiment_summary(const parameters::Parameters& parameters);

/// Returns a sentence about the changes that an experiment has planned for later generations, with a blank before it;
/// empty if it has planned none.
std::string schedule_summary(const parameters::Schedule& schedule, std::uint64_t after_generation);

} // namespace evod::protocol
