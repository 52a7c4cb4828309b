// Window layout: how a window is shared out: the strips around worlds and islands, worlds side by side, the islands of
// a world as tiles.
//
// Threads      none; pure functions.
#pragma once

#include "client/viewer/drawing/camera.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace evod::viewer {

/// Heights of strips in pixels at scale 1: of the panels' names, of a world's title, of its statistics.
constexpr float panel_strip = 26, top_strip = 38, bottom_strip = 30;

/// The strip at the top of a window that hands act upon, with the names of the panels.
Rectangle panel_strip_of(unsigned width_pixels, double scale = 1);
/// What that strip leaves to the worlds.
Rectangle below_panel_strip(unsigned width_pixels, unsigned height_pixels, double scale = 1);

/// The part of a window, or of a place in it, that the strips of a world leave to the island.
Rectangle viewport_of(Rectangle place, double scale = 1);
inline Rectangle viewport_of(unsigned width_pixels, unsigned height_pixels) {
    return viewport_of({0, 0, double(width_pixels), double(height_pixels)});
}

/// Pixels between neighbours.
constexpr double gap_pixels = 2;

/// `count` columns of one height, from the left, in whole pixels; the last takes what is left over.
std::vector<Rectangle> side_by_side(Rectangle place, std::size_t count);

/// `count` tiles of one size, row after row, in whole pixels, so that islands are seen as large as they can be.
///
/// aspect  width of an island by its height, above 0
std::vector<Rectangle> in_tiles(Rectangle place, std::size_t count, double aspect);

/// A window that wants a place.
struct PlaceWanted {
    double width, height;
    bool at_right; // rather than at the left, if both are as good
};
/// Where it covers nobody, as near to a side of the room as it can be, and there as high up; nullopt if there is no
/// such place.
///
/// taken  where others stand
/// apart  pixels from them, and from the edges of the room
std::optional<Rectangle> free_place(const PlaceWanted& wanted, Rectangle room, std::span<const Rectangle> taken,
                                    double apart);

} // namespace evod::viewer
