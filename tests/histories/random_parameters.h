// Random values of parameters: within their ranges, and such that a world stays small and most changes are accepted.
#pragma once

#include "server/parameters/model_parameters.h"
#include "tests/histories/draws.h"

#include <cstdint>
#include <vector>

namespace evod::histories {

parameters::ParameterValue random_value(const parameters::ParameterDescription& description, Draws& draws);

/// Draws assignments that mostly include this parameter.
///
/// with_resets  whether other parameters that wait for a reset may be among them.
std::vector<parameters::Assignment> random_assignments(const parameters::ParameterDescription& first, bool with_resets,
                                                       Draws& draws);

/// Chooses parameters so that each of them comes in its turn.
class ParameterTurns {
  public:
    explicit ParameterTurns(std::uint64_t first) : next_{first} {}
    const parameters::ParameterDescription& next();

  private:
    std::uint64_t next_;
};

} // namespace evod::histories
