#include "client/viewer/drawing/png.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

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

constexpr std::size_t pixel_bytes = 3;
constexpr int packing_level = 6; // of zlib, 1 to 9: its own default

/// With a black pixel to the left of the first, which filters look at.
using Row = std::vector<std::uint8_t>;

/// What filter `number` of PNG foretells of a byte, from that of the pixel to the left, that above, and that to the
/// left of it.
template <unsigned number>
std::uint8_t foretold(int left, int above, int corner) {
    if constexpr (number == 1) {
        return static_cast<std::uint8_t>(left);
    } else if constexpr (number == 2) {
        return static_cast<std::uint8_t>(above);
    } else if constexpr (number == 3) {
        return static_cast<std::uint8_t>((left + above) / 2);
    } else if constexpr (number == 4) { // Paeth's: the one that is nearest to left + above - corner
        const int by_left = std::abs(above - corner), by_above = std::abs(left - corner);
        const int by_corner = std::abs(left + above - 2 * corner);
        return static_cast<std::uint8_t>(by_left <= by_above && by_left <= by_corner ? left
                                         : by_above <= by_corner                     ? above
                                                                                     : corner);
    } else {
        return 0;
    }
}

/// Tells a row by how it differs from what a filter foretells; returns the sum of the differences' sizes.
template <unsigned number>
std::uint32_t filter(const Row& row, const Row& above, Row& told) {
    std::uint32_t sum = 0;
    for (std::size_t i = pixel_bytes; i < row.size(); ++i) {
        const int difference = row[i] - foretold<number>(row[i - pixel_bytes], above[i], above[i - pixel_bytes]);
        told[i] = static_cast<std::uint8_t>(difference);
        sum += static_cast<std::uint32_t>(std::abs(static_cast<std::int8_t>(difference)));
    }
    return sum;
}

/// Every row by the filter that leaves the least, which packs best as a rule.
///
/// Source   Portable Network Graphics (PNG) Specification, W3C 2003, 12.8 Filter selection.
std::string filtered_rows(const sf::Image& image) {
    const sf::Vector2u size = image.getSize();
    const std::size_t row_bytes = pixel_bytes * size.x;
    std::string rows;
    rows.reserve((row_bytes + 1) * size.y);
    Row row(pixel_bytes + row_bytes), above(row.size()), told(row.size()), best(row.size());
    const std::uint8_t* pixel = image.getPixelsPtr();
    constexpr auto filters = std::array{&filter<0>, &filter<1>, &filter<2>, &filter<3>, &filter<4>};
    for (unsigned y = 0; y < size.y; ++y) {
        for (std::size_t i = pixel_bytes; i < row.size(); i += pixel_bytes, pixel += 4) {
            std::memcpy(&row[i], pixel, pixel_bytes);
        }
        std::uint32_t least = std::numeric_limits<std::uint32_t>::max();
        for (std::size_t number = 0; number < filters.size(); ++number) {
            if (const std::uint32_t sum = filters[number](row, above, told); sum < least) {
                least = sum;
                best[pixel_bytes - 1] = static_cast<std::uint8_t>(number); // told first
                std::copy(told.begin() + pixel_bytes, told.end(), best.begin() + pixel_bytes);
            }
        }
        rows.append(best.begin() + pixel_bytes - 1, best.end());
        std::swap(row, above);
    }
    return rows;
}

} // namespace

std::string png_of(const sf::Image& image) {
    const sf::Vector2u size = image.getSize();
    const std::string rows = filtered_rows(image);
    uLongf packed_bytes = compressBound(rows.size());
    std::string packed(packed_bytes, '\0');
    compress2(reinterpret_cast<Bytef*>(packed.data()), &packed_bytes, reinterpret_cast<const Bytef*>(rows.data()),
              rows.size(), packing_level);
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
