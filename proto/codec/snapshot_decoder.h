// Snapshot decoder: converts a sequence of SnapshotFrames into snapshots for drawing. It decodes every codec, with and
// without tiles.
//
// It checks everything. The received bytes, and the counts checked against them, bound its memory. If any part of a
// snapshot is damaged, the decoder refuses the whole snapshot and all deltas before the next keyframe.
//
// Threads      only one thread uses a decoder.
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

/// Returns whether a frame can be decoded without an earlier frame.
bool is_keyframe(const evod::v1::SnapshotFrame& frame);

/// Decodes the snapshots of one island of one subscription.
class SnapshotDecoder {
  public:
    /// Decodes a frame. After Damage, all deltas before the next keyframe are refused.
    Result<ReceivedSnapshot> decode(evod::v1::SnapshotFrame frame);

    /// Returns whether the decoder needs a keyframe, because it has received none or because of damage.
    bool needs_keyframe() const { return !snapshot_; }

    /// The entities of the last snapshot with CODEC_DELTA; nullptr before the first keyframe. With a View, only the
    /// entities of tiles at DETAIL_FULL.
    const QuantisedSnapshot* snapshot() const { return snapshot_.get(); }

  private:
    struct WholeIsland {
        Baseline baseline;
        evod::v1::SnapshotFrame about; // the fields that deltas omit, and the sequence
    };
    struct Tiles {
        struct Base {
            std::uint64_t sequence = 0;
            Baseline baseline;
        };
        TileLayout layout;
        std::map<std::uint32_t, Base> bases; // key: index of a tile that was at DETAIL_FULL in the last snapshot
    };
    Result<ReceivedSnapshot> decode_whole(evod::v1::SnapshotFrame frame);
    Result<ReceivedSnapshot> decode_tiles(evod::v1::SnapshotFrame frame);
    void forget();

    std::shared_ptr<const QuantisedSnapshot> snapshot_;
    std::optional<WholeIsland> whole_;
    std::optional<Tiles> tiles_;
};

} // namespace evod::codec
