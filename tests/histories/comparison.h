// Comparison: finds the first difference between a world of a server and its twin, which was never stopped.
#pragma once

#include "server/base/executor.h"
#include "server/simulation/laboratory.h"

#include <optional>
#include <string>

namespace evod::histories {

/// How much is compared.
enum class Depth {
    Moment, // what a glance shows: moment, hash, parameters, planned changes, run control
    Whole,  // also the statistics, the changes of parameters, the organisms and the complete state
};

/// Returns the first difference as text: "the state hash: 12… but expected 34…"; nullopt if there is none.
///
/// executor  that of the server.
std::optional<std::string> difference_of(const simulation::Entry& world, const simulation::Entry& twin, Depth depth,
                                         base::Executor& executor);

} // namespace evod::histories
