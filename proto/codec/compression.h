// Compression of the bodies of pictures by zstd, and the checksum over them.
//
// Threads      a Compressor is used by one thread at a time; the functions by any.
#pragma once

#include "proto/codec/result.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace evod::codec {

/// Where in a body one column ends and the next begins, rising.
using Seams = std::vector<std::uint32_t>;

/// One zstd frame after another, each by itself, with working memory that stays warm.
class Compressor {
  public:
    Compressor();
    ~Compressor();
    Compressor(const Compressor&) = delete;
    Compressor& operator=(const Compressor&) = delete;

    /// seams  where numbers of another kind begin: what is long enough becomes a block of zstd's of its own, with a
    /// code
    ///        that suits it. What many random bytes stand beside would hardly be shortened otherwise.
    std::string compress(std::string_view bytes, const Seams& seams = {});

  private:
    struct Context;
    std::unique_ptr<Context> context_;
};

/// The content of a zstd frame that tells its size; more than bytes_max is refused before memory is taken for it.
Result<std::string> decompress(std::string_view bytes, std::uint64_t bytes_max);

/// CRC-32 as zlib has it. before: the checksum of the bytes that `bytes` follow, to go on from.
std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0);

} // namespace evod::codec
