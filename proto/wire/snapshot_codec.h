// Snapshot codec: an island's columns → the body of a SnapshotFrame → a picture, CODEC_COLUMNS. The layout is told in
// stream.proto.
//
// The server encodes a picture once for all its viewers; clients decode. The encoder is handed arrays that are right;
// the decoder trusts nothing.
//
// Threads      none; nothing here is shared.
// Determinism  bodies are little-endian whatever the machine, so equal columns are equal bytes.
#pragma once

#include "evod/v1/stream.pb.h"
#include "proto/wire/result.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace evod::wire {

/// All spans of one struct have the same length. Positions are centres, in fixed point: see IslandColumns.
struct OrganismColumns {
    std::span<const std::uint32_t> id; // rising
    std::span<const std::int32_t> x, y;
    std::span<const float> radius_px;
    std::span<const float> health;
};
struct ItemColumns {
    std::span<const std::uint32_t> id; // rising; only the items that are there to be eaten
    std::span<const std::int32_t> x, y;
};
struct BoxColumns {
    std::span<const std::int32_t> x, y;
    std::span<const float> half_width_px, half_height_px;
};

/// An island as the server holds it.
struct IslandColumns {
    double width_px = 0, height_px = 0;
    unsigned position_fraction_bits = 12; // an x or y of 1 is 2^-position_fraction_bits px; 4 to 30
    OrganismColumns organisms{};
    ItemColumns food{}, poison{};
    BoxColumns crates{}, obstacles{};
};

/// Sets width_px, height_px, codec, the counts, position_bytes and body of `frame`, and leaves its other fields alone.
///
/// Positions are rounded to the nearest 1/16 px (a half goes right or down); what is beyond the column's range stands
/// at its end. Throws std::invalid_argument where the columns of one struct differ in length.
void encode(const IslandColumns& columns, evod::v1::SnapshotFrame& frame);

struct OrganismPicture {
    std::vector<std::uint32_t> id; // rising
    std::vector<float> x_px, y_px, radius_px, health;
};
struct ItemPicture {
    std::vector<std::uint32_t> id; // rising
    std::vector<float> x_px, y_px;
};
struct BoxPicture {
    std::vector<float> x_px, y_px, half_width_px, half_height_px;
};

/// One picture of one island, ready to draw. All columns of a struct have the same length, and all numbers are finite.
struct Picture {
    evod::v1::SnapshotFrame about; // every field of the frame but its body: tick, walls, statistics, …
    OrganismPicture organisms;
    ItemPicture food, poison;
    BoxPicture crates, obstacles;
};

/// What is wrong with the fields around the body, if anything; whichever the codec is.
std::optional<Damage> damage_of_fields(const evod::v1::SnapshotFrame& frame);

/// A picture of CODEC_COLUMNS. Damage says which field is wrong, and how. Memory is taken only after the counts agree
/// with the body's length.
Result<Picture> decode(evod::v1::SnapshotFrame frame);

} // namespace evod::wire
