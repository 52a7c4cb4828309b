#include "client/viewer/drawing/png.h"

#include <zlib.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <stdexcept>

namespace evod::viewer {

namespace {

void add_number(std::string& bytes, std::uint32_t number) {
    for (int shift = 24; shift >= 0; shift -= 8) {
        bytes.push_back(static_cast<char>(number >> shift & 0xff));
    }
}

void add_chunk(std::string& bytes, const char* kind, const std::string& content) {
    add_number(bytes, static_cast<std::uint32_t>(content.size()));
    const std::string checked = kind + content;
    bytes += checked;
    add_number(bytes, static_cast<std::uint32_t>(
                          crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size()))));
}

} // namespace

std::string png_of(const sf::Image& image) {
    const sf::Vector2u size = image.getSize();
    const std::size_t row_bytes = std::size_t{3} * size.x;
    std::string rows; // each told by how it differs from the one above
    rows.reserve((row_bytes + 1) * size.y);
    std::string above(row_bytes, '\0'), row(row_bytes, '\0');
    const std::uint8_t* pixel = image.getPixelsPtr();
    for (unsigned y = 0; y < size.y; ++y) {
        for (std::size_t i = 0; i < row_bytes; i += 3, pixel += 4) {
            std::memcpy(&row[i], pixel, 3);
        }
        rows.push_back(2); // the filter "up"
        for (std::size_t i = 0; i < row_bytes; ++i) {
            rows.push_back(static_cast<char>(row[i] - above[i]));
        }
        std::swap(row, above);
    }
    uLongf packed_bytes = compressBound(rows.size());
    std::string packed(packed_bytes, '\0');
    compress2(reinterpret_cast<Bytef*>(packed.data()), &packed_bytes, reinterpret_cast<const Bytef*>(rows.data()),
              rows.size(), Z_BEST_SPEED);
    packed.resize(packed_bytes);

    std::string png = "\x89PNG\r\n\x1a\n", head;
    add_number(head, size.x);
    add_number(head, size.y);
    head += {8, 2, 0, 0, 0}; // bits, colours, and the only compression, filters and interlacing
    add_chunk(png, "IHDR", head);
    add_chunk(png, "IDAT", packed);
    add_chunk(png, "IEND", "");
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
    if (std::fclose(file) != 0 || !written) { // what is left in the buffer is written last
        errno = written ? errno : error;
        fail();
    }
}

} // namespace evod::viewer
