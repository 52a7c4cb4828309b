#include "proto/codec/compression.h"

#include <libdeflate.h>
#define ZSTD_STATIC_LINKING_ONLY // ZSTD_c_literalCompressionMode
#include <zstd.h>

#include <algorithm>
#include <new>
#include <span>
#include <utility>

namespace evod::codec {

namespace {

// The zstd level: the fastest of the regular levels, because the network thread waits for the compression.
constexpr int level = 1;
// zstd searches for matches at every 16th byte. Compared with every byte, encoding a world at full speed takes a
// quarter less time and 1 % more bytes.
constexpr int bytes_between_searches = 16;

constexpr std::size_t block_bytes_min = 1024; // a shorter block costs more bytes than it saves
constexpr std::size_t block_bytes_more = 16;  // overhead of one block

Damage not_zstd(const std::string& why) {
    return Damage{"a snapshot's body is not a zstd frame: " + why};
}

} // namespace

struct Compressor::Context {
    Context() : zstd{ZSTD_createCCtx()} {
        if (zstd == nullptr) {
            throw std::bad_alloc{};
        }
        ZSTD_CCtx_setParameter(zstd, ZSTD_c_compressionLevel, level);
        // Columns contain noise or nearly constant numbers. In them short matches are accidental and cost more than
        // they save. A small hash table is enough to find the long matches.
        ZSTD_CCtx_setParameter(zstd, ZSTD_c_minMatch, 7);
        ZSTD_CCtx_setParameter(zstd, ZSTD_c_hashLog, 8);
        // For the same reason zstd searches for matches only every few bytes. In this mode it would also omit entropy
        // coding, which makes columns shorter. If this version of zstd cannot keep entropy coding enabled, it searches
        // at every byte.
        if (!ZSTD_isError(ZSTD_CCtx_setParameter(zstd, ZSTD_c_literalCompressionMode, ZSTD_ps_enable))) {
            ZSTD_CCtx_setParameter(zstd, ZSTD_c_targetLength, bytes_between_searches);
        }
    }
    ~Context() { ZSTD_freeCCtx(zstd); }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    /// Returns uninitialised memory.
    std::span<char> room(std::size_t bytes) {
        if (room_bytes < bytes) {
            room_memory = std::make_unique_for_overwrite<char[]>(bytes);
            room_bytes = bytes;
        }
        return {room_memory.get(), bytes};
    }

    ZSTD_CCtx* zstd;
    std::unique_ptr<char[]> room_memory;
    std::size_t room_bytes = 0;
};

Compressor::Compressor() : context_{std::make_unique<Context>()} {}

Compressor::~Compressor() = default;

std::string Compressor::compress(std::string_view bytes, const Seams& seams) {
    ZSTD_CCtx* const zstd = context_->zstd;
    const std::span room = context_->room(ZSTD_compressBound(bytes.size()) + seams.size() * block_bytes_more);
    ZSTD_CCtx_reset(zstd, ZSTD_reset_session_only);
    ZSTD_CCtx_setPledgedSrcSize(zstd, bytes.size());
    ZSTD_outBuffer out{room.data(), room.size(), 0};
    std::size_t begin = 0;
    const auto put = [&](std::size_t end, ZSTD_EndDirective then) {
        ZSTD_inBuffer in{bytes.data() + begin, end - begin, 0};
        std::size_t left = 0;
        do {
            left = ZSTD_compressStream2(zstd, &out, &in, then);
        } while (!ZSTD_isError(left) && left > 0 && out.pos < out.size);
        // The output buffer has the maximum size of the result, so the only possible cause is a lack of memory.
        if (ZSTD_isError(left) || left > 0) {
            throw std::bad_alloc{};
        }
        begin = end;
    };
    for (const std::uint32_t seam : seams) {
        if (seam - begin >= block_bytes_min && bytes.size() - seam >= block_bytes_min) {
            put(seam, ZSTD_e_flush);
        }
    }
    put(bytes.size(), ZSTD_e_end);
    return {room.data(), out.pos};
}

Result<std::string> decompress(std::string_view bytes, std::uint64_t bytes_max) {
    const unsigned long long size = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
    if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR) {
        return not_zstd("it does not contain the size of its content");
    }
    if (size > bytes_max) {
        return Damage{"a snapshot's body has " + std::to_string(size) + " bytes of content, allowed by its counts " +
                      std::to_string(bytes_max)};
    }
    std::string content(size, '\0');
    const std::size_t got = ZSTD_decompress(content.data(), content.size(), bytes.data(), bytes.size());
    if (ZSTD_isError(got)) {
        return not_zstd(ZSTD_getErrorName(got));
    }
    if (got != size) {
        return not_zstd("its content is shorter than its size says");
    }
    return {boost::system::in_place_value, std::move(content)};
}

std::uint32_t crc32(std::string_view bytes, std::uint32_t before) {
    return libdeflate_crc32(before, bytes.data(), bytes.size());
}

} // namespace evod::codec
