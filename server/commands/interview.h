// Interview: the questions of `evod run --ask` about population, food, poison, time and the settings of the genetic
// algorithm.
#pragma once

#include "server/base/result.h"
#include "server/parameters/model_parameters.h"

#include <iosfwd>

namespace evod::commands {

/// Asks one question per parameter. An empty answer accepts the proposed value. After an invalid answer, prints the
/// allowed values and asks again.
///
/// proposed  the proposed values, which must be valid.
/// returns   valid parameters; a refusal if the input ends before the last answer.
base::Result<parameters::Parameters> interview(const parameters::Parameters& proposed, std::istream& in,
                                               std::ostream& out);

} // namespace evod::commands
