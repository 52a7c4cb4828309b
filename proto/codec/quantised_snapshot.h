// Quantised snapshot: the entities of a snapshot as whole numbers, in units of steps (steps.h). All
// codecs encode exactly these numbers.
#pragma once

#include "proto/codec/column.h"
#include "proto/codec/steps.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace evod::codec {

/// The entities of one kind, ordered by id. The boxes of an island have no ids and keep their order. All columns that
/// the kind uses have the same length; the other columns are empty.
struct Entities {
    // Organisms, food and poison have ids. In a tile, boxes have ids too: their indices on the island.
    Column id;
    Column x, y;
    Column width;     // organisms: radius; boxes: half width
    Column height;    // organisms: health; boxes: half height
    Column heading{}; // organisms that have a heading, if the viewer wants it
    Column species{}; // organisms of worlds with predators, if the viewer wants it: a number of evod::v1::Species

    // These functions return the values of entity i.
    std::uint32_t id_of(std::size_t i) const { return id.empty() ? static_cast<std::uint32_t>(i) : id[i]; }
    float x_px(std::size_t i) const { return px_of(x[i]); }
    float y_px(std::size_t i) const { return px_of(y[i]); }
    float radius_px(std::size_t i) const { return px_of(width[i]); }
    float health(std::size_t i) const { return px_of(height[i]); }
    bool has_headings() const { return !heading.empty(); }
    bool has_species() const { return !species.empty(); }
    std::uint32_t species_of(std::size_t i) const { return species.empty() ? 0 : species[i]; }
    float heading_radians(std::size_t i) const { return radians_of(heading[i]); }
    float half_width_px(std::size_t i) const { return px_of(width[i]); }
    float half_height_px(std::size_t i) const { return px_of(height[i]); }

    /// Returns the index of the entity with this id; nullopt if there is none. Requires the column `id`.
    std::optional<std::size_t> index_of(std::uint32_t wanted) const {
        const auto place = std::ranges::lower_bound(id, wanted);
        return place != id.end() && *place == wanted ? std::optional{static_cast<std::size_t>(place - id.begin())}
                                                     : std::nullopt;
    }
    friend bool operator==(const Entities&, const Entities&) = default;
};

/// The entities of one snapshot, or of one of its tiles.
struct QuantisedSnapshot {
    std::uint32_t position_bytes = 2; // size of a position: 2 or 4
    bool of_tile = false;             // true: boxes have ids, because they enter and leave tiles
    Entities organisms{}, food{}, poison{}, crates{}, obstacles{};
    friend bool operator==(const QuantisedSnapshot&, const QuantisedSnapshot&) = default;
};

/// The numbers of organisms, food, poison, crates and obstacles. All encodings use this order.
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
/// Returns the counts in a message. Message: SnapshotFrame or SnapshotTile.
template <class Message>
Counts counts_of(const Message& message) {
    return {message.organism_count(), message.food_count(), message.poison_count(), message.crate_count(),
            message.obstacle_count()};
}
/// Sets the counts in a message. Message: SnapshotFrame or SnapshotTile.
template <class Message>
void set_counts(const Counts& counts, Message& message) {
    message.set_organism_count(counts[0]);
    message.set_food_count(counts[1]);
    message.set_poison_count(counts[2]);
    message.set_crate_count(counts[3]);
    message.set_obstacle_count(counts[4]);
}

} // namespace evod::codec
