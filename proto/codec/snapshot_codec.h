// Snapshot codec: decoded snapshots, and CODEC_PLAIN. The message is described in stream.proto.
//
// The server encodes a snapshot once for all its viewers; clients decode it. The encoder's input is valid; the decoder
// checks everything.
//
// Threads      none; nothing here is shared.
// Determinism  all numbers are multiples of 1/16, which a float holds exactly, so all machines send equal bytes.
#pragma once

#include "evod/v1/stream.pb.h"
#include "proto/codec/quantised_snapshot.h"
#include "proto/codec/result.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace evod::codec {

/// Sets the counts and position_bytes of `frame`. Throws std::invalid_argument if the columns of a kind differ in length.
void describe(const QuantisedSnapshot& snapshot, evod::v1::SnapshotFrame& frame);

/// Sets codec, counts and `plain` of `frame`. snapshot: of a whole island.
void encode_plain(const QuantisedSnapshot& snapshot, evod::v1::SnapshotFrame& frame);

struct DecodedOrganisms {
    std::vector<std::uint32_t> id; // rising
    std::vector<float> x_px, y_px, radius_px, health;
};
struct DecodedItems {
    std::vector<std::uint32_t> id; // rising
    std::vector<float> x_px, y_px;
};
struct DecodedBoxes {
    std::vector<float> x_px, y_px, half_width_px, half_height_px;
    std::vector<std::uint32_t> id{}; // rising: the index on the island
};

/// A tile of DETAIL_DOTS: positions to 1/256 of its side.
struct DecodedDots {
    struct Places {
        std::vector<float> x_px, y_px;
    };
    Places organisms, food, poison, crates, obstacles;
};

/// A tile of DETAIL_DENSITY: the number of entities in each of cells_per_side squared squares, row after row.
struct DecodedDensity {
    std::uint32_t cells_per_side = 1;
    std::vector<std::uint32_t> organisms, food, poison;
};

/// A visible tile.
struct DecodedTile {
    std::uint32_t tile = 0; // index
    evod::v1::Detail detail = evod::v1::DETAIL_FULL;
    double left_px = 0, top_px = 0; // its upper left corner; its side is SnapshotFrame.tile_px
    DecodedDots dots;               // DETAIL_DOTS
    DecodedDensity density;         // DETAIL_DENSITY
};

/// One snapshot of one island, ready to draw. All columns of a struct have the same length, and all numbers are finite.
struct DecodedSnapshot {
    evod::v1::SnapshotFrame about; // every field of the frame but body, tiles and plain: tick, walls, statistics, …
    DecodedOrganisms organisms;    // with a View: those of all tiles of DETAIL_FULL; likewise the other kinds
    DecodedItems food, poison;
    DecodedBoxes crates, obstacles;
    std::vector<DecodedTile> tiles; // with a View: the visible tiles, indices rising
};

/// The first invalid field among those that do not contain entities, if any; for every codec.
std::optional<Damage> damage_of_fields(const evod::v1::SnapshotFrame& frame);

/// Decodes CODEC_PLAIN. Damage names the invalid field.
Result<DecodedSnapshot> decode_plain(evod::v1::SnapshotFrame frame);

} // namespace evod::codec
