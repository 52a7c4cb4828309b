// Quantised snapshot: the entities of a snapshot in whole numbers of 1/16 px or 1/16 of health (steps.h). All codecs encode
// exactly these numbers.
#pragma once

#include "proto/codec/column.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace evod::codec {

/// Entities of one kind, ids rising; the boxes of an island in their order. All columns that a kind has have one length; the
/// others are empty.
struct Entities {
    Column id; // organisms, food, poison; in a tile boxes too: the index on the island
    Column x, y;
    Column width;  // organisms: radius; boxes: half width
    Column height; // organisms: health; boxes: half height
    friend bool operator==(const Entities&, const Entities&) = default;
};

/// The entities of one snapshot, or of one of its tiles.
struct QuantisedSnapshot {
    std::uint32_t position_bytes = 2; // 2 or 4
    bool of_tile = false;             // boxes have ids, because they enter and leave tiles
    Entities organisms{}, food{}, poison{}, crates{}, obstacles{};
    friend bool operator==(const QuantisedSnapshot&, const QuantisedSnapshot&) = default;
};

/// Of organisms, food, poison, crates, obstacles: the order of everything that is encoded.
using Counts = std::array<std::uint32_t, 5>;
constexpr std::array<Entities QuantisedSnapshot::*, 5> snapshot_parts{
    &QuantisedSnapshot::organisms, &QuantisedSnapshot::food, &QuantisedSnapshot::poison, &QuantisedSnapshot::crates,
    &QuantisedSnapshot::obstacles};
inline Counts counts_of(const QuantisedSnapshot& snapshot) {
    Counts counts;
    std::ranges::transform(snapshot_parts, counts.begin(),
                           [&](auto part) { return static_cast<std::uint32_t>((snapshot.*part).x.size()); });
    return counts;
}
/// Message: SnapshotFrame or SnapshotTile.
template <class Message>
Counts counts_of(const Message& message) {
    return {message.organism_count(), message.food_count(), message.poison_count(), message.crate_count(),
            message.obstacle_count()};
}
/// Likewise.
template <class Message>
void set_counts(const Counts& counts, Message& message) {
    message.set_organism_count(counts[0]);
    message.set_food_count(counts[1]);
    message.set_poison_count(counts[2]);
    message.set_crate_count(counts[3]);
    message.set_obstacle_count(counts[4]);
}

} // namespace evod::codec
