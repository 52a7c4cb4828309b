// The model's version: what a run file names, so that no run is repeated by rules that are not its own.
#pragma once

#include <cstdint>

namespace evod::simulation {

/// Rises with every change of a rule after which a run could be another one, or be stored otherwise: whenever a golden
/// hash changes (tests/determinism/golden_test.cpp), and where no scenario of theirs shows the change.
///
/// 3: a child's first parent is the one that gave more of its genes; islands share their places among all that send
///    migrants.
constexpr std::uint32_t model_version = 3;

} // namespace evod::simulation
