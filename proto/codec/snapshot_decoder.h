// Picture decoder: SnapshotFrames, one after another, by any codec, whole or in tiles → pictures to draw.
//
// It trusts nothing: memory follows the bytes received and the counts checked against them, and after damage in any
// part of a picture all of it is refused, and every delta up to the next keyframe.
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

/// Whether a picture can be decoded by who knows none before it.
bool is_keyframe(const evod::v1::SnapshotFrame& frame);

/// The pictures of one island of one subscription.
class SnapshotDecoder {
  public:
    /// Damage says what is wrong; then every delta is refused up to the next keyframe.
    Result<DecodedSnapshot> decode(evod::v1::SnapshotFrame frame);

    /// Deltas are of no use now: there has been no keyframe yet, or damage after it.
    bool needs_keyframe() const { return !snapshot_; }

    /// What the last picture of CODEC_DELTA consisted of; null before a keyframe. With tiles, those of DETAIL_FULL.
    const QuantisedSnapshot* snapshot() const { return snapshot_.get(); }

  private:
    struct Whole {
        Baseline baseline;
        evod::v1::SnapshotFrame about; // what deltas leave out, and sequence
    };
    struct Tiles {
        struct Base {
            std::uint64_t sequence = 0;
            Baseline baseline;
        };
        TileLayout layout;
        std::map<std::uint32_t, Base> bases; // by index, of those that the last picture showed at DETAIL_FULL
    };
    Result<DecodedSnapshot> decode_whole(evod::v1::SnapshotFrame frame);
    Result<DecodedSnapshot> decode_tiles(evod::v1::SnapshotFrame frame);
    void forget();

    std::shared_ptr<const QuantisedSnapshot> snapshot_;
    std::optional<Whole> whole_;
    std::optional<Tiles> tiles_;
};

} // namespace evod::codec
