// Encoded island: one island at one tick, with the encodings that subscriptions of all rates share.
//
// Each encoding is computed when the first session sends it. All sessions then share its bytes.
//
// Owner        the StreamedSnapshots that use it (delta_stream.h).
// Threads      the network thread.
#pragma once

#include "evod/v1/stream.pb.h"
#include "proto/codec/compression.h"
#include "proto/codec/quantised_snapshot.h"
#include "proto/codec/shared_bytes.h"
#include "proto/codec/tiles.h"
#include "server/runtime/snapshot.h"
#include "server/streaming/snapshot_memory.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace evod::streaming {

/// The fields of a SnapshotFrame that describe the world and the island. Entities, codec and sequence are not set.
v1::SnapshotFrame frame_without_entities(const runtime::Snapshot& snapshot, const runtime::IslandSnapshot& island);

class EncodedIsland {
  public:
    /// about       a frame with its sequence, but without entities and codec.
    /// compressor  must exist until the last encoding is computed.
    /// memory      counts the memory of the island and its encodings; nullptr: none does.
    EncodedIsland(v1::SnapshotFrame about, codec::QuantisedSnapshot snapshot, codec::Compressor& compressor,
                  SnapshotMemory* memory = nullptr);

    const v1::SnapshotFrame& about() const { return about_; }
    std::uint64_t sequence() const { return about_.sequence(); }
    const codec::QuantisedSnapshot& snapshot() const { return *snapshot_; }
    /// The snapshot divided into tiles. The first call divides it.
    codec::SnapshotTiles& tiles();
    /// The entities of a tile.
    codec::QuantisedView full(std::uint32_t tile);

    SnapshotMemory* memory() const { return held_.memory(); }
    /// The memory of the island and of the encodings that it has computed and keeps.
    std::size_t bytes() const { return held_.bytes() + kept_encoding_bytes_; }

    /// Encodes fields 1 to 49 of a frame with CODEC_PLAIN.
    const SharedBytes& plain();
    /// Encodes fields 1 to 49 of a frame with CODEC_DELTA and without tiles. base_sequence: 0 for a keyframe.
    SharedBytes whole(std::uint64_t base_sequence, std::string_view body, const codec::Seams& seams,
                      v1::Compression compression);
    /// Encodes fields 1 to 49 of a frame with CODEC_DELTA and tiles, except the field `tiles`.
    const SharedBytes& without_tiles();
    /// Encodes one element of the field `tiles` at DETAIL_FULL.
    SharedBytes full_tile(std::uint32_t tile, std::uint64_t base_sequence, std::string_view body,
                          const codec::Seams& seams, v1::Compression compression);
    /// Encodes one element of the field `tiles` at DETAIL_DOTS or DETAIL_DENSITY.
    const SharedBytes& coarse_tile(std::uint32_t tile, v1::Detail detail, v1::Compression compression);

  private:
    /// Counts the memory of everything except the encodings, which are counted as long as a session sends them.
    void count_memory();
    const SharedBytes& keep(SharedBytes& place, std::string bytes);
    v1::SnapshotFrame delta_frame() const;
    std::string encode_tile(v1::SnapshotTile tile, std::string_view body, const codec::Seams& seams,
                            v1::Compression compression);

    std::shared_ptr<const codec::QuantisedSnapshot> snapshot_;
    v1::SnapshotFrame about_;
    codec::Compressor* compressor_;
    SnapshotBytes held_;
    std::size_t kept_encoding_bytes_ = 0;
    std::optional<codec::SnapshotTiles> tiles_;
    SharedBytes plain_, without_tiles_;
    std::vector<std::array<SharedBytes, 4>> coarse_; // index: tile; dots and density, each uncompressed and compressed
};

} // namespace evod::streaming
