// Window layout: divides a window into the sidebar and the world, and divides the part of a world into tiles
// for its islands.
//
// Owner        none: pure functions.
// Threads      any.
#pragma once

#include "client/viewer/drawing/camera.h"

#include <cstddef>
#include <vector>

namespace evod::viewer {

/// Heights in pixels at scale 1 of a world's title strip and of its statistics strip.
constexpr float top_strip = 38, bottom_strip = 30;

/// Widths in pixels at scale 1 of the sidebar, and of the strip that remains of a collapsed one.
constexpr float sidebar_width = 400, sidebar_collapsed = 26;

/// The width of the sidebar in whole pixels. The world keeps at least 45 % of the window.
double sidebar_pixels(unsigned window_pixels, double scale = 1);

/// The part of `place` in which the island is drawn: `place` without the title and statistics strips of its world.
Rectangle viewport_of(Rectangle place, double scale = 1);
inline Rectangle viewport_of(unsigned width_pixels, unsigned height_pixels) {
    return viewport_of({0, 0, double(width_pixels), double(height_pixels)});
}

/// Gap in pixels between neighbouring tiles.
constexpr double gap_pixels = 2;

/// Divides `place` into `count` tiles of equal size in whole pixels, row by row, so that the islands are as large as
/// possible.
///
/// aspect  width of an island divided by its height, > 0
std::vector<Rectangle> in_tiles(Rectangle place, std::size_t count, double aspect);

} // namespace evod::viewer
