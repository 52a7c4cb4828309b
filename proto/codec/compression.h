// Compression: converts bodies of snapshots to zstd frames and back, and computes their checksums.
//
// Threads      only one thread at a time may use a Compressor. Any thread may call the functions.
#pragma once

#include "proto/codec/result.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace evod::codec {

/// The offsets in a body at which columns begin, in rising order.
using Seams = std::vector<std::uint32_t>;

/// Compresses bytes to independent zstd frames, and reuses its working memory.
class Compressor {
  public:
    Compressor();
    ~Compressor();
    Compressor(const Compressor&) = delete;
    Compressor& operator=(const Compressor&) = delete;

    /// Compresses `bytes` to one zstd frame.
    ///
    /// seams  offsets at which the kind of number changes. Each part that is long enough becomes a zstd block with its
    ///        own entropy code. With one code for all parts, a regular column next to many random bytes would hardly
    ///        shrink.
    std::string compress(std::string_view bytes, const Seams& seams = {});

  private:
    struct Context;
    std::unique_ptr<Context> context_;
};

/// Decompresses a zstd frame that states the size of its content. If the size exceeds bytes_max, the result is Damage
/// and no memory is allocated.
Result<std::string> decompress(std::string_view bytes, std::uint64_t bytes_max);

/// CRC-32 as computed by zlib.
///
/// before  the checksum of the bytes that precede `bytes`.
std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0);

} // namespace evod::codec
