// Experiments in requests: the parameters and the schedule of a new world, from the fields of CreateWorld or from the
// text of an experiment file.
//
// Threads  none.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/parameters/experiment.h"

#include <vector>

namespace evod::protocol {

/// What a request gives a new world. Adds violations, named as the sender spells the fields, and then returns a default.
///
/// With experiment_json, `parameters` are changes to the experiment for all generations, and `schedule` must be empty.
parameters::Experiment experiment_of(const v1::CreateWorld& request, std::vector<base::Violation>& violations);

} // namespace evod::protocol
