#include "client/viewer/drawing/png.h"

#include "proto/files/unfinished_file.h"

#include <png.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <stdexcept>

namespace evod::viewer {

namespace {

/// Returns the red, green and blue bytes of all pixels, row by row.
std::string rgb_of(const sf::Image& image) {
    const std::size_t pixels = std::size_t{image.getSize().x} * image.getSize().y;
    std::string rgb(3 * pixels, '\0');
    const std::uint8_t* rgba = image.getPixelsPtr();
    for (std::size_t i = 0; i < pixels; ++i) {
        std::memcpy(&rgb[3 * i], rgba + 4 * i, 3);
    }
    return rgb;
}

} // namespace

std::string png_of(const sf::Image& image) {
    const std::string rgb = rgb_of(image);
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    header.format = PNG_FORMAT_RGB;
    header.width = image.getSize().x;
    header.height = image.getSize().y;
    png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(header);
    std::string png(bytes, '\0');
    if (png_image_write_to_memory(&header, png.data(), &bytes, 0, rgb.data(), 0, nullptr) == 0) {
        throw std::runtime_error{std::string{"could not encode the image as PNG: "} + header.message};
    }
    png.resize(bytes);
    return png;
}

void write_file(const std::string& path, const std::string& bytes) {
    errno = 0;
    files::UnfinishedFile file{path};
    file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!file.finish()) {
        throw std::runtime_error{"could not write " + path + ": " + std::strerror(errno)};
    }
}

} // namespace evod::viewer
