// The model's version: what a run file names, so that no run is repeated by rules that are not its own.
#pragma once

#include <cstdint>

namespace evod::simulation {

/// Rises whenever a golden hash changes (tests/determinism/golden_test.cpp).
constexpr std::uint32_t model_version = 2;

} // namespace evod::simulation
