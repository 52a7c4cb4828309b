// Encoded island: one island at one tick, and the bytes of it that subscriptions of every rate share.
//
// Each form is encoded when the first session sends it. The sessions then share the bytes.
//
// Owner        the streamed snapshots made from it (delta_stream.h).
// Threads      the network thread.
#pragma once

#include "evod/v1/stream.pb.h"
#include "proto/codec/compression.h"
#include "proto/codec/quantised_snapshot.h"
#include "proto/codec/shared_bytes.h"
#include "proto/codec/tiles.h"
#include "server/runtime/snapshot.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace evod::streaming {

using codec::SharedBytes;

/// The fields of a SnapshotFrame that describe the world and the island, without entities, codec and sequence.
v1::SnapshotFrame frame_about(const runtime::Snapshot& snapshot, const runtime::IslandSnapshot& island);

class EncodedIsland {
  public:
    /// about       the frame without entities and codec; with its sequence.
    /// compressor  must live until the last form has been encoded.
    EncodedIsland(v1::SnapshotFrame about, codec::QuantisedSnapshot snapshot, codec::Compressor& compressor);

    const v1::SnapshotFrame& about() const { return about_; }
    std::uint64_t sequence() const { return about_.sequence(); }
    const codec::QuantisedSnapshot& snapshot() const { return *snapshot_; }
    /// The snapshot cut into tiles, on the first call.
    codec::SnapshotTiles& tiles();

    /// Fields 1 to 49 of a frame of CODEC_PLAIN.
    const SharedBytes& plain();
    /// Fields 1 to 49 of a frame of CODEC_DELTA without tiles. base_sequence: 0 for a keyframe.
    SharedBytes whole(std::uint64_t base_sequence, std::string_view body, const codec::Seams& seams,
                      v1::Compression compression);
    /// Fields 1 to 49 of a frame of CODEC_DELTA in tiles, without the field `tiles`.
    const SharedBytes& without_tiles();
    /// One element of the field `tiles`, at DETAIL_FULL.
    SharedBytes full_tile(std::uint32_t tile, std::uint64_t base_sequence, std::string_view body,
                          const codec::Seams& seams, v1::Compression compression);
    /// One element of the field `tiles`, at DETAIL_DOTS or DETAIL_DENSITY.
    const SharedBytes& coarse_tile(std::uint32_t tile, v1::Detail detail, v1::Compression compression);

  private:
    v1::SnapshotFrame delta_frame() const;
    SharedBytes encode_tile(v1::SnapshotTile tile, std::string_view body, const codec::Seams& seams,
                            v1::Compression compression);

    std::shared_ptr<const codec::QuantisedSnapshot> snapshot_;
    v1::SnapshotFrame about_;
    codec::Compressor* compressor_;
    std::optional<codec::SnapshotTiles> tiles_;
    SharedBytes plain_, without_tiles_;
    std::vector<std::array<SharedBytes, 4>> coarse_; // by tile: dots and densities, each plain and compressed
};

} // namespace evod::streaming
