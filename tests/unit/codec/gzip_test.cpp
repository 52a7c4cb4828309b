#include "proto/codec/gzip.h"

#include <gtest/gtest.h>
#include <libdeflate.h>

#include <string>

namespace evod::codec {
namespace {

std::string unpacked(const std::string& packed, std::size_t bytes_max) {
    std::string bytes(bytes_max, '\0');
    std::size_t count = 0;
    libdeflate_decompressor* const decompressor = libdeflate_alloc_decompressor();
    EXPECT_EQ(
        libdeflate_gzip_decompress(decompressor, packed.data(), packed.size(), bytes.data(), bytes.size(), &count),
        LIBDEFLATE_SUCCESS);
    libdeflate_free_decompressor(decompressor);
    bytes.resize(count);
    return bytes;
}

TEST(Gzip, KeepsEveryByte) {
    std::string bytes;
    for (int i = 0; i < 70'000; ++i) {
        bytes += static_cast<char>((i * i >> 3) % 251);
    }
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{1000}, bytes.size()}) {
        EXPECT_EQ(unpacked(gzip(bytes.substr(0, count)), bytes.size()), bytes.substr(0, count));
    }
}

TEST(Gzip, MakesRepetitionsShorter) {
    EXPECT_LT(gzip(std::string(100'000, 'x')).size(), 1'000U);
}

} // namespace
} // namespace evod::codec
