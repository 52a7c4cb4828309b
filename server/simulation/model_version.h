// The version of the model. Every run file contains it, so that a run is never recomputed under different rules.
#pragma once

#include <cstdint>

namespace evod::simulation {

/// Increases with every change of a rule that can change a run or its stored form: whenever a golden hash changes
/// (tests/determinism/golden_test.cpp), and for changes that no golden scenario shows.
///
/// 4: immigrants never replace the elite; the chromosomes of worlds without bodies that clients rate consist of the
/// free genes alone, if there are any; seeds of replicates are below 2^53.
/// 3: a child's first parent is the parent that gave more of its genes; an island shares its places among all islands
/// that send migrants.
constexpr std::uint32_t model_version = 4;

} // namespace evod::simulation
