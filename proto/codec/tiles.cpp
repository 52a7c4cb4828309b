#include "proto/codec/tiles.h"

#include "proto/codec/body.h"
#include "proto/codec/compression.h"
#include "proto/codec/steps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

namespace evod::codec {

namespace {

constexpr unsigned place_bits = 8; // number of bits for a position within a tile
constexpr unsigned cells_per_side_log2_max = 4;
constexpr std::size_t counted_parts = 3; // a density counts organisms, food and poison

/// Returns the number of tiles in one row or column.
double tiles_along(double length_px, std::uint32_t tile_px) {
    return std::max(1.0, std::ceil(length_px / tile_px));
}

/// Returns the index of the first of `count` tiles that begins at or after `px`.
std::uint32_t first_tile_from(double px, std::uint32_t tile_px, std::uint32_t count) {
    return static_cast<std::uint32_t>(std::clamp(std::ceil(px / tile_px), 0.0, double{1} * count));
}

/// Returns the index of the last of `count` tiles that begins at or before `px`.
std::uint32_t last_tile_up_to(double px, std::uint32_t tile_px, std::uint32_t count) {
    return static_cast<std::uint32_t>(std::clamp(std::floor(px / tile_px), 0.0, double{1} * count));
}

} // namespace

TileLayout tile_layout(double width_px, double height_px) {
    std::uint32_t tile_px = tile_px_min;
    while (tiles_along(width_px, tile_px) * tiles_along(height_px, tile_px) > tiles_max) {
        tile_px *= 2;
    }
    return {.width_px = width_px,
            .height_px = height_px,
            .tile_px = tile_px,
            .columns = static_cast<std::uint32_t>(tiles_along(width_px, tile_px)),
            .rows = static_cast<std::uint32_t>(tiles_along(height_px, tile_px))};
}

Result<TileLayout> tile_layout_of(const evod::v1::SnapshotFrame& frame) {
    const std::uint32_t tile_px = frame.tile_px();
    // The client accepts more tiles than this version of the server sends. The limit is the range of the indices.
    constexpr double count_max = 1 << 24;
    if (!std::has_single_bit(tile_px)) {
        return Damage{"a snapshot's tile_px is " + std::to_string(tile_px) + ", not a power of two"};
    }
    const double columns = tiles_along(frame.width_px(), tile_px), rows = tiles_along(frame.height_px(), tile_px);
    if (columns * rows > count_max) {
        return Damage{"a snapshot's tile_px is " + std::to_string(tile_px) + ", too small for its island"};
    }
    return TileLayout{.width_px = frame.width_px(),
                      .height_px = frame.height_px(),
                      .tile_px = tile_px,
                      .columns = static_cast<std::uint32_t>(columns),
                      .rows = static_cast<std::uint32_t>(rows)};
}

TileRange tiles_of(const evod::v1::Region& region, const TileLayout& layout) {
    const double right_px = region.left_px() + region.width_px(), bottom_px = region.top_px() + region.height_px();
    if (right_px <= 0 || bottom_px <= 0 || region.left_px() >= layout.width_px || region.top_px() >= layout.height_px) {
        return {};
    }
    return {.column_begin = last_tile_up_to(region.left_px(), layout.tile_px, layout.columns),
            .column_end = first_tile_from(right_px, layout.tile_px, layout.columns),
            .row_begin = last_tile_up_to(region.top_px(), layout.tile_px, layout.rows),
            .row_end = first_tile_from(bottom_px, layout.tile_px, layout.rows)};
}

TileRange tiles_of(const TileLayout& layout) {
    return {.column_begin = 0, .column_end = layout.columns, .row_begin = 0, .row_end = layout.rows};
}

SnapshotTiles::SnapshotTiles(std::shared_ptr<const QuantisedSnapshot> snapshot, const TileLayout& layout)
    : snapshot_{std::move(snapshot)}
    , layout_{layout}
    , side_log2_{static_cast<unsigned>(std::countr_zero(layout.tile_px)) + steps_per_px_log2}
    , gathered_(layout.count()) {
    const std::uint32_t count = layout_.count();
    std::vector<std::uint16_t> tiles;
    static_assert(tiles_max <= 1 << 16);
    std::uint64_t counted = 0;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
        const Entities& entities = (*snapshot_).*snapshot_parts[p];
        const std::size_t size = entities.x.size();
        Part& part = parts_[p];
        part.begin.resize(count + 1);
        if (size == 0) {
            continue;
        }
        tiles.resize(size);
        for (std::size_t i = 0; i < size; ++i) { // an entity on a wall belongs to the last tile before the wall
            const std::uint32_t column = std::min(entities.x[i] >> side_log2_, layout_.columns - 1);
            const std::uint32_t row = std::min(entities.y[i] >> side_log2_, layout_.rows - 1);
            tiles[i] = static_cast<std::uint16_t>(row * layout_.columns + column);
        }
        for (const std::uint16_t tile : tiles) {
            ++part.begin[tile + 1U];
        }
        std::partial_sum(part.begin.begin(), part.begin.end(), part.begin.begin());
        std::vector<std::uint32_t> next{part.begin.begin(), part.begin.end() - 1};
        part.order.resize(size);
        for (std::size_t i = 0; i < size; ++i) {
            part.order[next[tiles[i]]++] = static_cast<std::uint32_t>(i);
        }
        counted += p < counted_parts ? size : 0;
    }
    // There are on average two entities per cell. A density then needs about half as many bytes as dots.
    while (cells_per_side_log2_ < cells_per_side_log2_max &&
           (std::uint64_t{count} << (2 * (cells_per_side_log2_ + 1))) <= counted / 2) {
        ++cells_per_side_log2_;
    }
}

std::span<const std::uint32_t> SnapshotTiles::of(std::size_t part, std::uint32_t tile) const {
    const Part& all = parts_[part];
    return std::span{all.order}.subspan(all.begin[tile], all.begin[tile + 1] - all.begin[tile]);
}

Counts SnapshotTiles::counts(std::uint32_t tile) const {
    Counts counts;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
        counts[p] = static_cast<std::uint32_t>(of(p, tile).size());
    }
    return counts;
}

Counts SnapshotTiles::counts_before(std::uint32_t tile) const {
    Counts counts;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
        counts[p] = parts_[p].begin[tile];
    }
    return counts;
}

QuantisedView SnapshotTiles::full(std::uint32_t tile) {
    QuantisedView view;
    view.position_bytes = snapshot_->position_bytes;
    view.of_tile = true;
    constexpr std::array<EntitiesView QuantisedView::*, snapshot_parts.size()> parts_seen{
        &QuantisedView::organisms, &QuantisedView::food, &QuantisedView::poison, &QuantisedView::crates,
        &QuantisedView::obstacles};
    const bool gathers = !gathered_[tile];
    gathered_[tile] = true;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
        const Numbers indices = of(p, tile);
        if (indices.empty()) {
            continue;
        }
        Part& part = parts_[p];
        const std::uint32_t begin = part.begin[tile];
        const Entities& from = (*snapshot_).*snapshot_parts[p];
        const auto column = [&](std::size_t c, const Column& whole) -> Numbers {
            if (whole.empty()) {
                return {};
            }
            if (!part.columns[c]) {
                part.columns[c] = std::make_unique_for_overwrite<std::uint32_t[]>(whole.size());
            }
            std::uint32_t* const to = part.columns[c].get() + begin;
            for (std::size_t i = 0; gathers && i < indices.size(); ++i) {
                to[i] = whole[indices[i]];
            }
            return {to, indices.size()};
        };
        view.*parts_seen[p] = {from.id.empty() ? indices : column(0, from.id),
                               column(1, from.x),
                               column(2, from.y),
                               column(3, from.width),
                               column(4, from.height),
                               column(5, from.heading),
                               column(6, from.species)};
    }
    return view;
}

std::size_t SnapshotTiles::held_bytes() const {
    std::size_t bytes = gathered_.size() / 8;
    for (const Part& part : parts_) {
        const auto columns = static_cast<std::size_t>(
            std::ranges::count_if(part.columns, [](const auto& column) { return column != nullptr; }));
        bytes += (part.order.size() * (1 + columns) + part.begin.size()) * sizeof(std::uint32_t);
    }
    return bytes;
}

SnapshotTiles::Place SnapshotTiles::place(const Entities& entities, std::uint32_t entity, std::uint32_t tile) const {
    const auto within = [&](std::uint32_t position, std::uint32_t index) {
        const std::uint32_t steps = position - (index << side_log2_);
        return static_cast<std::uint8_t>(std::min(steps, (1U << side_log2_) - 1) >> (side_log2_ - place_bits));
    };
    return {within(entities.x[entity], tile % layout_.columns), within(entities.y[entity], tile / layout_.columns)};
}

std::string SnapshotTiles::dots(std::uint32_t tile) const {
    std::string body;
    const Counts counts = this->counts(tile);
    const auto count = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
    body.resize(2 * count);
    std::size_t next = 0;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
        for (const std::uint32_t entity : of(p, tile)) {
            const Place at = place((*snapshot_).*snapshot_parts[p], entity, tile);
            body[next] = static_cast<char>(at.x);
            body[count + next++] = static_cast<char>(at.y);
        }
    }
    return body;
}

std::string SnapshotTiles::density(std::uint32_t tile) const {
    BodyWriter writer;
    writer.number(static_cast<std::uint8_t>(1U << cells_per_side_log2_));
    const unsigned shift = place_bits - cells_per_side_log2_;
    Column cells(std::size_t{1} << (2 * cells_per_side_log2_));
    for (std::size_t p = 0; p < counted_parts; ++p) {
        std::fill(cells.begin(), cells.end(), 0U);
        for (const std::uint32_t entity : of(p, tile)) {
            const Place at = place((*snapshot_).*snapshot_parts[p], entity, tile);
            ++cells[(static_cast<std::size_t>(at.y >> shift) << cells_per_side_log2_) + (at.x >> shift)];
        }
        writer.column(cells);
    }
    return writer.take();
}

Result<QuantisedSnapshot> merged(std::uint32_t position_bytes, std::span<const QuantisedSnapshot* const> tiles) {
    QuantisedSnapshot snapshot{.position_bytes = position_bytes, .of_tile = true};
    struct Found {
        std::uint32_t id, tile, index;
    };
    std::vector<Found> found;
    for (const auto part : snapshot_parts) {
        found.clear();
        for (std::size_t t = 0; t < tiles.size(); ++t) {
            const Column& ids = (tiles[t]->*part).id;
            for (std::size_t i = 0; i < ids.size(); ++i) {
                found.push_back({ids[i], static_cast<std::uint32_t>(t), static_cast<std::uint32_t>(i)});
            }
        }
        std::ranges::sort(found, {}, &Found::id);
        if (const auto twice = std::ranges::adjacent_find(found, {}, &Found::id); twice != found.end()) {
            return Damage{"a snapshot has id " + std::to_string(twice->id) + " in two tiles"};
        }
        Entities& to = snapshot.*part;
        const auto gather = [&](Column Entities::*column) {
            for (const Found& entity : found) {
                const Column& from = tiles[entity.tile]->*part.*column;
                if (!from.empty()) { // this kind has the column
                    (to.*column).push_back(from[entity.index]);
                }
            }
        };
        for (const auto column : {&Entities::id, &Entities::x, &Entities::y, &Entities::width, &Entities::height,
                                  &Entities::heading, &Entities::species}) {
            gather(column);
        }
        if (to.has_headings() && to.heading.size() != to.x.size()) {
            return Damage{"a snapshot has headings only in some tiles"};
        }
        if (to.has_species() && to.species.size() != to.x.size()) {
            return Damage{"a snapshot has species only in some tiles"};
        }
    }
    return snapshot;
}

Result<DecodedDots> decode_dots(std::string_view body, const Counts& counts, const TileLayout& layout,
                                std::uint32_t tile) {
    const auto count = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
    if (body.size() != 2 * count) {
        return Damage{"a tile's body is " + std::to_string(body.size()) + " bytes long, not " +
                      std::to_string(2 * count) + " as its counts say"};
    }
    const float unit_px = static_cast<float>(layout.tile_px) / (1U << place_bits);
    const auto in_px = [&](std::string_view places, std::uint32_t index) {
        const float corner_px = static_cast<float>(index) * static_cast<float>(layout.tile_px);
        std::vector<float> column(places.size());
        std::transform(places.begin(), places.end(), column.begin(), [&](char place) {
            return corner_px + (static_cast<float>(static_cast<unsigned char>(place)) + 0.5F) * unit_px;
        });
        return column;
    };
    DecodedDots dots;
    std::size_t next = 0;
    const std::array<DecodedDots::Places*, 5> parts{&dots.organisms, &dots.food, &dots.poison, &dots.crates,
                                                    &dots.obstacles};
    for (std::size_t p = 0; p < parts.size(); ++p) {
        parts[p]->x_px = in_px(body.substr(next, counts[p]), tile % layout.columns);
        parts[p]->y_px = in_px(body.substr(count + next, counts[p]), tile / layout.columns);
        next += counts[p];
    }
    return dots;
}

Result<DecodedDensity> decode_density(std::string_view body, const Counts& counts) {
    BodyReader reader{body};
    DecodedDensity density;
    density.cells_per_side = reader.number<std::uint8_t>();
    if (!std::has_single_bit(density.cells_per_side) || density.cells_per_side > 1U << cells_per_side_log2_max) {
        reader.refuse("has " + std::to_string(density.cells_per_side) + " cells per row, not 1, 2, 4, 8 or 16");
        return *reader.damage();
    }
    const std::array<std::vector<std::uint32_t>*, counted_parts> parts{&density.organisms, &density.food,
                                                                       &density.poison};
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const Column cells = reader.column(std::size_t{density.cells_per_side} * density.cells_per_side);
        if (!reader.damage() && std::accumulate(cells.begin(), cells.end(), std::uint64_t{0}) != counts[p]) {
            reader.refuse("has cells whose numbers of entities do not add up to the counts of the tile");
        }
        parts[p]->assign(cells.begin(), cells.end());
    }
    if (reader.rest_bytes() > 0) {
        reader.refuse("has surplus bytes at its end");
    }
    if (reader.damage()) {
        return *reader.damage();
    }
    return density;
}

std::uint32_t checksum_of(std::uint32_t tile_px, std::uint32_t position_bytes, const evod::v1::SnapshotTile& tile,
                          std::string_view body) {
    std::array<char, 3 * 4> place;
    store(tile_px, &place[0]);
    store(std::uint32_t{tile.tile()}, &place[4]);
    store(static_cast<std::uint32_t>(tile.detail()), &place[8]);
    return checksum_of({.sequence = tile.sequence(),
                        .base_sequence = tile.base_sequence(),
                        .counts = counts_of(tile),
                        .position_bytes = position_bytes},
                       body, crc32({place.data(), place.size()}));
}

} // namespace evod::codec
