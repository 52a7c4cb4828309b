// Interview: asks on a terminal for population, food, poison, time and every choice of the algorithm (`--ask`).
#pragma once

#include "server/base/result.h"
#include "server/parameters/parameters.h"

#include <iosfwd>

namespace evod::commands {

/// Asks one question a parameter; an empty answer takes what is proposed. An answer that cannot be is explained and
/// asked for again.
///
/// proposed  what each question proposes; valid.
/// returns   a valid set; refused if the input ends before the last answer.
base::Result<parameters::Parameters> interview(const parameters::Parameters& proposed, std::istream& in,
                                               std::ostream& out);

} // namespace evod::commands
