// Valid snapshots: what holds of every decoded snapshot. The columns of a struct have one length, numbers are finite, counts
// equal those of the frame, and ids rise.
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

inline void require_rising(const std::vector<std::uint32_t>& ids) {
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

inline void require_valid(const codec::DecodedSnapshot& snapshot) {
    const auto& organisms = snapshot.organisms;
    require_rising(organisms.id);
    for (const auto* column : {&organisms.x_px, &organisms.y_px, &organisms.radius_px, &organisms.health}) {
        require_finite(*column, organisms.id.size());
    }
    for (const auto* items : {&snapshot.food, &snapshot.poison}) {
        require_rising(items->id);
        require_finite(items->x_px, items->id.size());
        require_finite(items->y_px, items->id.size());
    }
    for (const auto* boxes : {&snapshot.crates, &snapshot.obstacles}) {
        require_rising(boxes->id);
        for (const auto* column : {&boxes->x_px, &boxes->y_px, &boxes->half_width_px, &boxes->half_height_px}) {
            require_finite(*column, boxes->id.size());
        }
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
    require(organisms.id.size() == snapshot.about.organism_count());
    require(snapshot.food.id.size() == snapshot.about.food_count());
    require(snapshot.poison.id.size() == snapshot.about.poison_count());
    require(snapshot.crates.id.size() == snapshot.about.crate_count());
    require(snapshot.obstacles.id.size() == snapshot.about.obstacle_count());
}

} // namespace evod::fuzz
