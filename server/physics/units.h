// Units: places are whole numbers of 1/4096 px. Constants alone, so that kernels (base/lanes.h) may include it.
#pragma once

#include <cstdint>

namespace evod::physics {

using Coordinate = std::int32_t;
constexpr Coordinate units_per_px = 4096;
constexpr float px_per_unit = 1.0f / units_per_px;

/// Where what is not there pretends to be: further from any place on an island than anything reaches, so that loops
/// need not ask whether it is there.
constexpr Coordinate elsewhere = -(1 << 30);

} // namespace evod::physics
