#include "proto/codec/gzip.h"

#include <libdeflate.h>

#include <memory>
#include <new>

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

} // namespace evod::codec
