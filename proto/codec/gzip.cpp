#include "proto/codec/gzip.h"

#include <libdeflate.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <stdexcept>

namespace evod::codec {

std::string gzip(std::string_view bytes) {
    constexpr int level_max = 12;
    const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor{
        libdeflate_alloc_compressor(level_max), &libdeflate_free_compressor};
    if (compressor == nullptr) {
        throw std::bad_alloc{};
    }
    std::string compressed(libdeflate_gzip_compress_bound(compressor.get(), bytes.size()), '\0');
    compressed.resize(
        libdeflate_gzip_compress(compressor.get(), bytes.data(), bytes.size(), compressed.data(), compressed.size()));
    return compressed;
}

std::string gunzip(std::string_view compressed) {
    constexpr std::size_t size_bytes = 4; // at the end, little-endian: the size of the content
    const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> decompressor{
        libdeflate_alloc_decompressor(), &libdeflate_free_decompressor};
    if (decompressor == nullptr) {
        throw std::bad_alloc{};
    }
    std::size_t size = 0;
    for (std::size_t i = 1; i <= std::min(size_bytes, compressed.size()); ++i) {
        size = size << 8 | static_cast<unsigned char>(compressed[compressed.size() - i]);
    }
    std::string bytes(size, '\0');
    if (libdeflate_gzip_decompress(decompressor.get(), compressed.data(), compressed.size(), bytes.data(), bytes.size(),
                                   nullptr) != LIBDEFLATE_SUCCESS) {
        throw std::runtime_error{"not a gzip member"};
    }
    return bytes;
}

} // namespace evod::codec
