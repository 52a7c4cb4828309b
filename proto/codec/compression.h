// Compression: bodies of snapshots to zstd frames and back, and their checksum.
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

/// The offsets in a body at which columns begin, rising.
using Seams = std::vector<std::uint32_t>;

/// Makes independent zstd frames, and reuses its working memory.
class Compressor {
  public:
    Compressor();
    ~Compressor();
    Compressor(const Compressor&) = delete;
    Compressor& operator=(const Compressor&) = delete;

    /// seams  where numbers of another kind begin. Each long enough part becomes a zstd block with its own entropy code.
    ///        Otherwise a regular column beside many random bytes would hardly become shorter.
    std::string compress(std::string_view bytes, const Seams& seams = {});

  private:
    struct Context;
    std::unique_ptr<Context> context_;
};

/// The content of a zstd frame that contains its size. More than bytes_max is Damage, before memory is allocated.
Result<std::string> decompress(std::string_view bytes, std::uint64_t bytes_max);

/// CRC-32, as in zlib. before: the checksum of the bytes that precede `bytes`.
std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0);

} // namespace evod::codec
