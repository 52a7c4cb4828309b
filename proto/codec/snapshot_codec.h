// Snapshot codec: a snapshot → the body of a SnapshotFrame → a picture, CODEC_COLUMNS. The layout is told in
// stream.proto.
//
// The server encodes a picture once for all its viewers; clients decode. The encoder is handed snapshots that are right;
// the decoder trusts nothing.
//
// Threads      none; nothing here is shared.
// Determinism  bodies are little-endian whatever the machine, so equal columns are equal bytes.
#pragma once

#include "evod/v1/stream.pb.h"
#include "proto/codec/quantised_snapshot.h"
#include "proto/codec/result.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace evod::codec {

/// Sets the counts and position_bytes of `frame`, and leaves its other fields alone. Throws std::invalid_argument where
/// the columns of a kind differ in length.
void describe(const QuantisedSnapshot& snapshot, evod::v1::SnapshotFrame& frame);

/// Sets codec, body and checksum of `frame` too, which has its sequence. snapshot: of a whole island.
void encode(const QuantisedSnapshot& snapshot, evod::v1::SnapshotFrame& frame);

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
    std::vector<std::uint32_t> id{}; // rising: the index among the island's
};

/// What a tile of DETAIL_DOTS shows: where its entities are, to 1/256 of its side.
struct DecodedDots {
    struct Places {
        std::vector<float> x_px, y_px;
    };
    Places organisms, food, poison, crates, obstacles;
};

/// What a tile of DETAIL_DENSITY shows: how many there are in each of cells_per_side squared squares, row after row.
struct DecodedDensity {
    std::uint32_t cells_per_side = 1;
    std::vector<std::uint32_t> organisms, food, poison;
};

/// A tile that is seen.
struct DecodedTile {
    std::uint32_t tile = 0; // index
    evod::v1::Detail detail = evod::v1::DETAIL_FULL;
    double left_px = 0, top_px = 0; // its corner; its side is SnapshotFrame.tile_px
    DecodedDots dots;               // DETAIL_DOTS
    DecodedDensity density;         // DETAIL_DENSITY
};

/// One picture of one island, ready to draw. All columns of a struct have the same length, and all numbers are finite.
struct DecodedSnapshot {
    evod::v1::SnapshotFrame about; // every field of the frame but its body and tiles: tick, walls, statistics, …
    DecodedOrganisms organisms;    // with tiles, of all those of DETAIL_FULL together; so too the others
    DecodedItems food, poison;
    DecodedBoxes crates, obstacles;
    std::vector<DecodedTile> tiles; // with a View: those that are seen, by rising index
};

/// What is wrong with the fields around the body, if anything; whichever the codec is.
std::optional<Damage> damage_of_fields(const evod::v1::SnapshotFrame& frame);

/// A picture of CODEC_COLUMNS. Damage says which field is wrong, and how. Memory is taken only after the counts agree
/// with the body's length.
Result<DecodedSnapshot> decode(evod::v1::SnapshotFrame frame);

} // namespace evod::codec
