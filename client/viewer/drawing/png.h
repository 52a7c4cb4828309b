// PNG: encodes an image as the bytes of a PNG file, and writes files. Errors name the path.
//
// Owner        none: functions. The film recorder calls png_of() on its own threads.
// Threads      any.
#pragma once

#include <SFML/Graphics/Image.hpp>

#include <string>

namespace evod::viewer {

/// Encodes the red, green and blue channels of an image with 8 bits each, without the alpha channel. Throws
/// std::runtime_error with the reason that libpng gives, for example for an image without pixels.
std::string png_of(const sf::Image& image);

/// Writes a file and replaces an existing one. Throws std::runtime_error with the path and the reason.
void write_file(const std::string& path, const std::string& bytes);

} // namespace evod::viewer
