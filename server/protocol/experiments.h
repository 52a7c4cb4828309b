// Experiments in requests: reads the parameters and the schedule of a new world, either from the fields of CreateWorld
// or from the text of an experiment file.
//
// Threads  none.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/parameters/experiment.h"

#include <vector>

namespace evod::protocol {

/// Reads the experiment in a request. For each invalid field it adds a violation, which names the field as the sender
/// spells it. If there is a violation, it returns the default experiment.
///
/// With experiment_json, `parameters` change the experiment for all generations, and `schedule` must be empty.
parameters::Experiment experiment_of(const v1::CreateWorld& request, std::vector<base::Violation>& violations);

} // namespace evod::protocol
