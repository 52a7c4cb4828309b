// Snapshot decoder: a sequence of SnapshotFrames of any codec, whole or in tiles → snapshots to draw.
//
// It checks everything: memory is bounded by the bytes received and the counts checked against them. Damage in any part
// refuses the whole snapshot, and every delta up to the next keyframe.
//
// Threads      a decoder is used by one thread.
#pragma once

#include "evod/v1/stream.pb.h"
#include "proto/codec/delta_codec.h"
#include "proto/codec/result.h"
#include "proto/codec/snapshot_codec.h"
#include "proto/codec/tiles.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>

namespace evod::codec {

/// Whether a frame can be decoded without an earlier one.
bool is_keyframe(const evod::v1::SnapshotFrame& frame);

/// Decodes the snapshots of one island of one subscription.
class SnapshotDecoder {
  public:
    /// After Damage every delta is refused up to the next keyframe.
    Result<DecodedSnapshot> decode(evod::v1::SnapshotFrame frame);

    /// Deltas cannot be decoded: there has been no keyframe yet, or damage after it.
    bool needs_keyframe() const { return !snapshot_; }

    /// The entities of the last snapshot of CODEC_DELTA; null before a keyframe. With a View, those of tiles of DETAIL_FULL.
    const QuantisedSnapshot* snapshot() const { return snapshot_.get(); }

  private:
    struct Whole {
        Baseline baseline;
        evod::v1::SnapshotFrame about; // the fields that deltas omit, and sequence
    };
    struct Tiles {
        struct Base {
            std::uint64_t sequence = 0;
            Baseline baseline;
        };
        TileLayout layout;
        std::map<std::uint32_t, Base> bases; // by index, of the tiles at DETAIL_FULL in the last snapshot
    };
    Result<DecodedSnapshot> decode_whole(evod::v1::SnapshotFrame frame);
    Result<DecodedSnapshot> decode_tiles(evod::v1::SnapshotFrame frame);
    void forget();

    std::shared_ptr<const QuantisedSnapshot> snapshot_;
    std::optional<Whole> whole_;
    std::optional<Tiles> tiles_;
};

} // namespace evod::codec
