#include "client/viewer/drawing/png.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>
#include <string>

namespace evod::viewer {
namespace {

template <class Shade>
sf::Image image_of(unsigned width, unsigned height, Shade shade) {
    sf::Image image;
    image.create(width, height);
    for (unsigned y = 0; y < height; ++y) {
        for (unsigned x = 0; x < width; ++x) {
            image.setPixel(x, y, shade(x, y));
        }
    }
    return image;
}

void expect_read_back(const sf::Image& image) {
    const std::string png = png_of(image);
    sf::Image read;
    ASSERT_TRUE(read.loadFromMemory(png.data(), png.size()));
    ASSERT_EQ(read.getSize(), image.getSize());
    for (unsigned y = 0; y < read.getSize().y; ++y) {
        for (unsigned x = 0; x < read.getSize().x; ++x) {
            ASSERT_EQ(read.getPixel(x, y), image.getPixel(x, y)) << x << ", " << y;
        }
    }
}

sf::Uint8 byte(unsigned number) {
    return static_cast<sf::Uint8>(number);
}

// Rows for each of which another of the five PNG filters is the best.
sf::Color any_filter(unsigned x, unsigned y) {
    const unsigned noise = (x * 2654435761u ^ y * 40503u * 2246822519u) >> 13;
    switch (y / 8 % 5) {
    case 0:
        return {byte(noise % 3), byte(noise / 3 % 3), byte(noise / 9 % 3)};
    case 1:
        return {byte(x * 3 + 70 * y), byte(90 * y), byte(x + 50 * y)};
    case 2:
        return {byte(x * x), byte(x * 91), byte(x * x * 7)};
    case 3:
        return {byte(5 * x + 5 * y + noise % 7), byte(9 * x + 9 * y), byte(3 * x + 3 * y + noise % 5)};
    default:
        return {byte(x > y ? 200 : x * 7), byte(y * 3 + x * 5), byte(x / 9 * 40 + y / 3 * 20)};
    }
}

TEST(Png, EveryPixelIsReadBack) {
    expect_read_back(image_of(61, 83, any_filter));
    expect_read_back(image_of(1, 1, [](unsigned, unsigned) { return sf::Color{1, 2, 255}; }));
    expect_read_back(image_of(1, 40, any_filter));
    expect_read_back(image_of(40, 1, any_filter));
}

TEST(Png, UniformAndRegularImagesAreSmall) {
    const auto bytes = [](auto shade) { return png_of(image_of(256, 256, shade)).size(); };
    EXPECT_LT(bytes([](unsigned, unsigned) { return sf::Color{204, 204, 204}; }), 1'000u);
    EXPECT_LT(bytes([](unsigned x, unsigned y) { return sf::Color{byte(x), byte(y), byte(x + y)}; }), 2'000u);
    // Unrelated columns; then unrelated rows, each with a constant slope.
    EXPECT_LT(bytes([](unsigned x, unsigned) { return sf::Color{byte(x * 91), byte(x * x), byte(x * 37)}; }), 3'000u);
    EXPECT_LT(
        bytes([](unsigned x, unsigned y) {
            const unsigned start = y * y * 7;
            return sf::Color{byte(start + x * (y % 7)), byte(3 * start + x * (y % 5)), byte(x * (y % 11) - start)};
        }),
        10'000u);
}

TEST(Png, AnImageWithoutPixelsIsRefused) {
    EXPECT_THROW(png_of(sf::Image{}), std::runtime_error);
}

} // namespace
} // namespace evod::viewer
