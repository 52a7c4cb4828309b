// Snapshot codec: received snapshots, and the codec CODEC_PLAIN. stream.proto describes the message.
//
// The server encodes a snapshot once for all viewers, and the clients decode it. The input of the encoder must be
// valid. The decoder checks everything.
//
// Threads      none; nothing here is shared.
// Determinism  all numbers are multiples of 1/16, which a float represents exactly, so all machines send equal bytes.
#pragma once

#include "evod/v1/stream.pb.h"
#include "proto/codec/quantised_snapshot.h"
#include "proto/codec/result.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace evod::codec {

/// Sets the counts and position_bytes of `frame`. Throws std::invalid_argument if the columns of one kind differ in
/// length.
void describe(const QuantisedSnapshot& snapshot, evod::v1::SnapshotFrame& frame);

/// Sets codec, counts and `plain` of `frame`. The snapshot must be of a whole island.
void encode_plain(const QuantisedSnapshot& snapshot, evod::v1::SnapshotFrame& frame);

/// A tile at DETAIL_DOTS. Positions are in 1/256 of its side.
struct DecodedDots {
    struct Places {
        std::vector<float> x_px, y_px;
    };
    Places organisms, food, poison, crates, obstacles;
};

/// A tile at DETAIL_DENSITY: a grid of cells_per_side × cells_per_side cells, row after row, with the number of
/// entities in each.
struct DecodedDensity {
    std::uint32_t cells_per_side = 1;
    std::vector<std::uint32_t> organisms, food, poison;
};

/// A tile that the viewer sees.
struct DecodedTile {
    std::uint32_t tile = 0; // index of the tile
    evod::v1::Detail detail = evod::v1::DETAIL_FULL;
    double left_px = 0, top_px = 0; // upper left corner of the tile; its side is SnapshotFrame.tile_px
    DecodedDots dots;               // set at DETAIL_DOTS
    DecodedDensity density;         // set at DETAIL_DENSITY
};

/// One snapshot of one island, as a client stores and draws it.
struct ReceivedSnapshot {
    evod::v1::SnapshotFrame about; // all fields of the frame except body, tiles and plain
    // Never null. The decoder of CODEC_DELTA shares these columns. With a View, each kind contains the entities of all
    // tiles at DETAIL_FULL.
    std::shared_ptr<const QuantisedSnapshot> entities = std::make_shared<const QuantisedSnapshot>();
    std::vector<DecodedTile> tiles{}; // with a View: the visible tiles, in order of their indices
};

/// Returns the first invalid field, if any, among those that do not contain entities. Applies to all codecs.
std::optional<Damage> damage_of_fields(const evod::v1::SnapshotFrame& frame);

/// Decodes a frame with CODEC_PLAIN. Damage names the invalid field.
Result<ReceivedSnapshot> decode_plain(evod::v1::SnapshotFrame frame);

} // namespace evod::codec
