// Colours of the pixels of an image.
#pragma once

#include "client/viewer/drawing/palette.h"

#include <SFML/Graphics/Image.hpp>

#include <cstddef>

namespace evod::viewer {

inline Colour pixel_at(const sf::Image& image, unsigned x, unsigned y) {
    const sf::Color is = image.getPixel(x, y);
    return {is.r, is.g, is.b};
}

/// The number of pixels with exactly this colour.
inline std::size_t count(const sf::Image& image, Colour colour) {
    std::size_t found = 0;
    for (unsigned y = 0; y < image.getSize().y; ++y) {
        for (unsigned x = 0; x < image.getSize().x; ++x) {
            found += pixel_at(image, x, y) == colour;
        }
    }
    return found;
}

} // namespace evod::viewer
