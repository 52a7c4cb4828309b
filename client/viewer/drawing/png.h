// PNG: a picture as the bytes of a file, and files whose errors are told.
//
// Threads      none.
#pragma once

#include <SFML/Graphics/Image.hpp>

#include <string>

namespace evod::viewer {

/// 8 bits each of red, green and blue; what shines through is left out.
std::string png_of(const sf::Image& image);

/// Writes a whole file, in the place of one that is there. Throws std::runtime_error that names path and reason.
void write_file(const std::string& path, const std::string& bytes);

} // namespace evod::viewer
