#include "client/viewer/drawing/png.h"

#include <png.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
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
    const auto fail = [&] { throw std::runtime_error{"could not write " + path + ": " + std::strerror(errno)}; };
    FILE* file = std::fopen(path.c_str(), "wb");
    if (file == nullptr) {
        fail();
    }
    const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    const int error = errno;
    if (std::fclose(file) != 0 || !written) { // fclose() writes the rest of the buffer, so it can fail too
        errno = written ? errno : error;
        fail();
    }
}

} // namespace evod::viewer
