// Window layout: divides a window into strips, worlds side by side, the islands of a world as tiles, and places for
// panels.
//
// Owner        none: pure functions.
// Threads      any.
#pragma once

#include "client/viewer/drawing/camera.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace evod::viewer {

/// Heights of strips in pixels at scale 1: of the panels' names, of a world's title, of its statistics.
constexpr float panel_strip = 26, top_strip = 38, bottom_strip = 30;

/// The strip at the top of an interactive window, with the names of the panels.
Rectangle panel_strip_of(unsigned width_pixels, double scale = 1);
/// The rest of the window, for the worlds.
Rectangle below_panel_strip(unsigned width_pixels, unsigned height_pixels, double scale = 1);

/// The part of a window, or of a place in it, that remains for the island after the strips of its world.
Rectangle viewport_of(Rectangle place, double scale = 1);
inline Rectangle viewport_of(unsigned width_pixels, unsigned height_pixels) {
    return viewport_of({0, 0, double(width_pixels), double(height_pixels)});
}

/// Pixels between neighbouring worlds or tiles.
constexpr double gap_pixels = 2;

/// `count` columns of the same height, from the left, in whole pixels; the last takes the remaining width.
std::vector<Rectangle> side_by_side(Rectangle place, std::size_t count);

/// `count` tiles of the same size, row by row, in whole pixels, arranged so that islands are as large as possible.
///
/// aspect  width of an island divided by its height, > 0
std::vector<Rectangle> in_tiles(Rectangle place, std::size_t count, double aspect);

/// A panel to be placed.
struct PlaceWanted {
    double width, height;
    bool at_right; // prefer the right side if both are equally good
};
/// The free place nearest to the left or right edge of the room, and there the highest; nullopt if no place is free.
///
/// taken  the rectangles of other panels
/// apart  pixels to keep from them and from the edges of the room
std::optional<Rectangle> free_place(const PlaceWanted& wanted, Rectangle room, std::span<const Rectangle> taken,
                                    double apart);

} // namespace evod::viewer
