#include "client/viewer/drawing/window_layout.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace evod::viewer {

namespace {

/// The size in pixels of each of `count` equal parts of `whole` pixels, with gaps between the parts.
double share(double whole, std::size_t count) {
    return std::max(std::floor((whole - gap_pixels * static_cast<double>(count - 1)) / static_cast<double>(count)),
                    1.0);
}

bool overlap(const Rectangle& a, const Rectangle& b) {
    return a.left < b.left + b.width && b.left < a.left + a.width && a.top < b.top + b.height &&
           b.top < a.top + a.height;
}

} // namespace

Rectangle panel_strip_of(unsigned width_pixels, double scale) {
    return {0, 0, double(width_pixels), std::round(panel_strip * scale)};
}

Rectangle below_panel_strip(unsigned width_pixels, unsigned height_pixels, double scale) {
    const double top = panel_strip_of(width_pixels, scale).height;
    return {0, top, double(width_pixels), std::max(height_pixels - top, 1.0)};
}

Rectangle viewport_of(Rectangle place, double scale) {
    const double top = std::round(top_strip * scale), bottom = std::round(bottom_strip * scale);
    return {place.left, place.top + top, place.width, std::max(place.height - top - bottom, 1.0)};
}

std::vector<Rectangle> side_by_side(Rectangle place, std::size_t count) {
    std::vector<Rectangle> columns;
    const double width = share(place.width, std::max<std::size_t>(count, 1));
    for (std::size_t i = 0; i < count; ++i) {
        columns.push_back({place.left + static_cast<double>(i) * (width + gap_pixels), place.top, width, place.height});
    }
    if (!columns.empty()) {
        columns.back().width = std::max(place.left + place.width - columns.back().left, 1.0);
    }
    return columns;
}

std::vector<Rectangle> in_tiles(Rectangle place, std::size_t count, double aspect) {
    std::size_t columns = 1;
    double largest = 0;
    for (std::size_t tried = 1; tried <= count; ++tried) {
        const std::size_t rows = (count + tried - 1) / tried;
        const double height = std::min(share(place.width, tried) / aspect, share(place.height, rows));
        if (height > largest) {
            largest = height;
            columns = tried;
        }
    }
    const std::size_t rows = std::max<std::size_t>((count + columns - 1) / columns, 1);
    const double width = share(place.width, columns), height = share(place.height, rows);
    std::vector<Rectangle> result;
    for (std::size_t i = 0; i < count; ++i) {
        result.push_back({place.left + static_cast<double>(i % columns) * (width + gap_pixels),
                          place.top + static_cast<double>(i / columns) * (height + gap_pixels), width, height});
    }
    return result;
}

std::optional<Rectangle> free_place(const PlaceWanted& wanted, Rectangle room, std::span<const Rectangle> taken,
                                    double apart) {
    const double left = room.left + apart, right = room.left + room.width - apart - wanted.width;
    const double top = room.top + apart, bottom = room.top + room.height - apart - wanted.height;
    std::vector<double> lefts{left, right}, tops{top};
    for (const Rectangle& other : taken) {
        lefts.push_back(other.left - apart - wanted.width);
        lefts.push_back(other.left + other.width + apart);
        tops.push_back(other.top + other.height + apart);
    }
    std::optional<Rectangle> best;
    const auto cost = [&](const Rectangle& place) {
        const double from_left = place.left - left, from_right = right - place.left;
        const bool at_right = from_right < from_left || (from_right == from_left && wanted.at_right);
        return std::tuple{std::min(from_left, from_right), at_right != wanted.at_right, place.top};
    };
    for (const double x : lefts) {
        for (const double y : tops) {
            const Rectangle place{x, y, wanted.width, wanted.height};
            const bool inside = x >= left && x <= right && y >= top && y <= bottom;
            const bool covers =
                std::ranges::any_of(taken, [&](const Rectangle& other) { return overlap(place, other); });
            if (inside && !covers && (!best || cost(place) < cost(*best))) {
                best = place;
            }
        }
    }
    return best;
}

} // namespace evod::viewer
