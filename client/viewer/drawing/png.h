// PNG: encodes an image as the bytes of a PNG file, and writes files with errors that name the path.
//
// Owner        none: functions. The film recorder calls png_of() on its own threads.
// Threads      any.
#pragma once

#include <SFML/Graphics/Image.hpp>

#include <string>

namespace evod::viewer {

/// 8 bits each of red, green and blue; alpha is dropped. Throws std::runtime_error with libpng's reason, for example
/// for an image without pixels.
std::string png_of(const sf::Image& image);

/// Writes a whole file and replaces an existing one. Throws std::runtime_error that names path and reason.
void write_file(const std::string& path, const std::string& bytes);

} // namespace evod::viewer
