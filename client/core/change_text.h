// Change text: formats parameter values and changes of parameters for people.
#pragma once

#include "evod/v1/world.pb.h"

#include <string>

namespace evod::core {

/// Returns the shortest text of the value: "0.05", "25", "true", "tournament"; "-" without a value.
std::string to_text(const v1::ParameterValue& value);

/// Returns "generation 20: mutation_chance 0.01 → 0.2, food_count 25 → 7 by alice".
std::string to_text(const v1::AppliedChange& change);

} // namespace evod::core
