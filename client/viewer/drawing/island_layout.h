// Island layout: how a window is shared out: worlds side by side, the islands of a world as tiles.
//
// Threads      none; pure functions.
#pragma once

#include "client/viewer/drawing/camera.h"

#include <cstddef>
#include <vector>

namespace evod::viewer {

/// Pixels between neighbours.
constexpr double gap_pixels = 2;

/// `count` columns of one height, from the left, in whole pixels; the last takes what is left over.
std::vector<Rectangle> side_by_side(Rectangle place, std::size_t count);

/// `count` tiles of one size, row after row, in whole pixels, so that islands are seen as large as they can be.
///
/// aspect  width of an island by its height, above 0
std::vector<Rectangle> in_tiles(Rectangle place, std::size_t count, double aspect);

} // namespace evod::viewer
