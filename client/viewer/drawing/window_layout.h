// Window layout: divides a window into strips and columns for worlds, divides the part of a world into tiles for its
// islands, and finds free places for panels.
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

/// Heights in pixels at scale 1 of the strip with the panels' names, of a world's title strip and of its statistics
/// strip.
constexpr float panel_strip = 26, top_strip = 38, bottom_strip = 30;

/// The strip at the top of an interactive window, with the names of the panels.
Rectangle panel_strip_of(unsigned width_pixels, double scale = 1);
/// The part of the window below the strip of panel names; it shows the worlds.
Rectangle below_panel_strip(unsigned width_pixels, unsigned height_pixels, double scale = 1);

/// The part of `place` in which the island is drawn: `place` without the title and statistics strips of its world.
Rectangle viewport_of(Rectangle place, double scale = 1);
inline Rectangle viewport_of(unsigned width_pixels, unsigned height_pixels) {
    return viewport_of({0, 0, double(width_pixels), double(height_pixels)});
}

/// Gap in pixels between neighbouring worlds or tiles.
constexpr double gap_pixels = 2;

/// Divides `place` into `count` columns of whole pixels, from left to right. The last column takes the remaining width.
std::vector<Rectangle> side_by_side(Rectangle place, std::size_t count);

/// Divides `place` into `count` tiles of equal size in whole pixels, row by row, so that the islands are as large as
/// possible.
///
/// aspect  width of an island divided by its height, > 0
std::vector<Rectangle> in_tiles(Rectangle place, std::size_t count, double aspect);

/// A panel for which free_place() finds a place.
struct PlaceWanted {
    double width, height;
    bool at_right; // prefer the right edge if both edges are equally good
};
/// The free place nearest to the left or right edge of `room`; among equally near places, the highest. Returns nullopt
/// if no place is free.
///
/// taken  the rectangles of the other panels
/// apart  distance in pixels to keep from the other panels and from the edges of `room`
std::optional<Rectangle> free_place(const PlaceWanted& wanted, Rectangle room, std::span<const Rectangle> taken,
                                    double apart);

} // namespace evod::viewer
