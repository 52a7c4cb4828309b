#include "proto/wire/compression.h"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <new>
#include <utility>

namespace evod::wire {

namespace {

// The fastest of the ordinary levels: a picture waits for it on the network thread.
constexpr int level = 1;

Damage not_zstd(const std::string& why) {
    return Damage{"a snapshot's body is not a zstd frame: " + why};
}

} // namespace

struct Compressor::Context {
    Context() : zstd{ZSTD_createCCtx()} {
        if (zstd == nullptr) {
            throw std::bad_alloc{};
        }
    }
    ~Context() { ZSTD_freeCCtx(zstd); }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    ZSTD_CCtx* zstd;
};

Compressor::Compressor() : context_{std::make_unique<Context>()} {}

Compressor::~Compressor() = default;

std::string Compressor::compress(std::string_view bytes) {
    std::string compressed(ZSTD_compressBound(bytes.size()), '\0');
    const std::size_t size =
        ZSTD_compressCCtx(context_->zstd, compressed.data(), compressed.size(), bytes.data(), bytes.size(), level);
    if (ZSTD_isError(size)) { // with room for the bound nothing but memory can be missing
        throw std::bad_alloc{};
    }
    compressed.resize(size);
    return compressed;
}

Result<std::string> decompress(std::string_view bytes, std::uint64_t bytes_max) {
    const unsigned long long size = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
    if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR) {
        return not_zstd("it does not tell the size of its content");
    }
    if (size > bytes_max) {
        return Damage{"a snapshot's body holds " + std::to_string(size) + " bytes, not at most the " +
                      std::to_string(bytes_max) + " of its counts"};
    }
    std::string content(size, '\0');
    const std::size_t got = ZSTD_decompress(content.data(), content.size(), bytes.data(), bytes.size());
    if (ZSTD_isError(got)) {
        return not_zstd(ZSTD_getErrorName(got));
    }
    if (got != size) {
        return not_zstd("its content is shorter than it tells");
    }
    return {boost::system::in_place_value, std::move(content)};
}

std::uint32_t crc32(std::string_view bytes, std::uint32_t before) {
    return static_cast<std::uint32_t>(
        crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

} // namespace evod::wire
