// Interview: the questions of `evod run --ask`, about population, food, poison, time and every option of the genetic algorithm.
#pragma once

#include "server/base/result.h"
#include "server/parameters/parameters.h"

#include <iosfwd>

namespace evod::commands {

/// Asks one question per parameter. An empty answer accepts the proposed value. After an invalid answer, it prints what
/// is allowed and asks again.
///
/// proposed  the proposed values; valid.
/// returns   valid parameters; refused if the input ends before the last answer.
base::Result<parameters::Parameters> interview(const parameters::Parameters& proposed, std::istream& in,
                                               std::ostream& out);

} // namespace evod::commands
