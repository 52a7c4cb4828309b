#include "client/viewer/drawing/window_layout.h"

#include <algorithm>
#include <cmath>

namespace evod::viewer {

namespace {

/// The size in pixels of each of `count` equal parts of `whole` pixels, with gaps between the parts.
double share(double whole, std::size_t count) {
    return std::max(std::floor((whole - gap_pixels * static_cast<double>(count - 1)) / static_cast<double>(count)),
                    1.0);
}

} // namespace

double sidebar_pixels(unsigned window_pixels, double scale) {
    constexpr double share_max = 0.55;
    return std::floor(std::min(double{sidebar_width} * scale, share_max * window_pixels));
}

Rectangle viewport_of(Rectangle place, double scale) {
    const double top = std::round(top_strip * scale), bottom = std::round(bottom_strip * scale);
    return {place.left, place.top + top, place.width, std::max(place.height - top - bottom, 1.0)};
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

} // namespace evod::viewer
