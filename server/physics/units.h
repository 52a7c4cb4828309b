// Units: positions are whole numbers of 1/4096 px. This file contains only constants, so that kernels (base/lanes.h)
// may include it.
#pragma once

#include <cstdint>

namespace evod::physics {

using Coordinate = std::int32_t;
constexpr Coordinate units_per_px = 4096;
constexpr float px_per_unit = 1.0f / units_per_px;

/// The position of void bodies. It is so far from every place on an island that nothing reaches it, so loops need no
/// test for void bodies.
constexpr Coordinate void_position = -(1 << 30);

} // namespace evod::physics
