// Valid snapshots: what holds of every decoded snapshot. The columns of a kind have one length, the numbers of dots are
// finite, counts equal those of the frame, and ids rise.
#pragma once

#include "proto/codec/snapshot_codec.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace evod::fuzz {

inline void require(bool holds, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    if (!holds) {
        std::fprintf(stderr, "%s:%d does not hold\n", file, line);
        std::abort();
    }
}

inline void require_finite(const std::vector<float>& column, std::size_t size) {
    require(column.size() == size);
    require(std::all_of(column.begin(), column.end(), [](float value) { return std::isfinite(value); }));
}

inline void require_rising(const codec::Column& ids) {
    require(std::adjacent_find(ids.begin(), ids.end(), std::greater_equal<>{}) == ids.end());
}

inline void require_valid_tile(const codec::DecodedTile& tile) {
    const codec::DecodedDots& dots = tile.dots;
    for (const auto* places : {&dots.organisms, &dots.food, &dots.poison, &dots.crates, &dots.obstacles}) {
        require_finite(places->x_px, places->x_px.size());
        require_finite(places->y_px, places->x_px.size());
    }
    const std::size_t cells = tile.density.cells_per_side * std::size_t{tile.density.cells_per_side};
    for (const auto* counts : {&tile.density.organisms, &tile.density.food, &tile.density.poison}) {
        require(counts->size() == (tile.detail == v1::DETAIL_DENSITY ? cells : 0));
    }
}

inline void require_valid(const codec::ReceivedSnapshot& snapshot) {
    const codec::QuantisedSnapshot& entities = *snapshot.entities;
    for (const auto part : codec::snapshot_parts) {
        const codec::Entities& kind = entities.*part;
        const bool items = part == &codec::QuantisedSnapshot::food || part == &codec::QuantisedSnapshot::poison;
        const bool whole_boxes = kind.id.empty() && (part == &codec::QuantisedSnapshot::crates ||
                                                     part == &codec::QuantisedSnapshot::obstacles);
        const std::size_t size = kind.x.size();
        require_rising(kind.id);
        require(kind.id.size() == (whole_boxes ? 0 : size) && kind.y.size() == size);
        for (const codec::Column* column : {&kind.width, &kind.height}) {
            require(column->size() == (items ? 0 : size));
        }
        require(kind.heading.empty() || (part == &codec::QuantisedSnapshot::organisms && kind.heading.size() == size));
        require(std::ranges::all_of(kind.heading, [](auto steps) { return steps < codec::heading_steps; }));
        require(kind.species.empty() || (part == &codec::QuantisedSnapshot::organisms && kind.species.size() == size));
        require(std::ranges::all_of(kind.species, [](auto species) { return species < 256; }));
    }
    require(std::ranges::adjacent_find(snapshot.tiles, std::ranges::greater_equal{}, &codec::DecodedTile::tile) ==
            snapshot.tiles.end());
    for (const auto& tile : snapshot.tiles) {
        require_valid_tile(tile);
    }
    if (snapshot.about.tile_px() > 0 && snapshot.about.codec() == v1::CODEC_DELTA) {
        return; // its counts are those of the whole island
    }
    require(snapshot.tiles.empty());
    require(codec::counts_of(entities) == codec::counts_of(snapshot.about));
}

} // namespace evod::fuzz
