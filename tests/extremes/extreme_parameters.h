// Extreme parameters: valid sets of parameters, many of which are at an edge of what is permitted.
#pragma once

#include "server/parameters/model_parameters.h"
#include "tests/histories/draws.h"

namespace evod::extremes {

using histories::Draws;

/// Draws a valid set. Each parameter that is drawn gets its least or greatest value, a value next to one of them, or a
/// value of any magnitude. If the other parameters do not permit this value, it gets the permitted value that is
/// nearest to it. Counts stay so small that a tick takes at most about a millisecond.
parameters::Parameters extreme_parameters(Draws& draws);

/// Draws one such assignment for a set.
parameters::Assignment extreme_assignment(const parameters::Parameters& set, Draws& draws);

} // namespace evod::extremes
