// The version of the model. Every run file contains it, so that a run is never recomputed under different rules.
#pragma once

#include <cstdint>

namespace evod::simulation {

/// Increases with every change of a rule that can change a run or its stored form: whenever a golden hash changes
/// (tests/determinism/golden_test.cpp), and for changes that no golden scenario shows.
///
/// 3: a child's first parent is the parent that gave more of its genes; an island shares its places among all islands
/// that send migrants.
constexpr std::uint32_t model_version = 3;

} // namespace evod::simulation
