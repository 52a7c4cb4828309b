// What every decoded picture must be: columns of one length in each struct, finite numbers, the counts that its frame
// tells, ids that rise.
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

inline void require_sound_tile(const codec::DecodedTile& tile) {
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

inline void require_sound(const codec::DecodedSnapshot& picture) {
    const auto& organisms = picture.organisms;
    require_rising(organisms.id);
    for (const auto* column : {&organisms.x_px, &organisms.y_px, &organisms.radius_px, &organisms.health}) {
        require_finite(*column, organisms.id.size());
    }
    for (const auto* items : {&picture.food, &picture.poison}) {
        require_rising(items->id);
        require_finite(items->x_px, items->id.size());
        require_finite(items->y_px, items->id.size());
    }
    for (const auto* boxes : {&picture.crates, &picture.obstacles}) {
        require_rising(boxes->id);
        for (const auto* column : {&boxes->x_px, &boxes->y_px, &boxes->half_width_px, &boxes->half_height_px}) {
            require_finite(*column, boxes->id.size());
        }
    }
    require(std::ranges::adjacent_find(picture.tiles, std::ranges::greater_equal{}, &codec::DecodedTile::tile) ==
            picture.tiles.end());
    for (const auto& tile : picture.tiles) {
        require_sound_tile(tile);
    }
    if (picture.about.tile_px() > 0 && picture.about.codec() == v1::CODEC_DELTA) {
        return; // its counts are of the whole island
    }
    require(picture.tiles.empty());
    require(organisms.id.size() == picture.about.organism_count());
    require(picture.food.id.size() == picture.about.food_count());
    require(picture.poison.id.size() == picture.about.poison_count());
    require(picture.crates.id.size() == picture.about.crate_count());
    require(picture.obstacles.id.size() == picture.about.obstacle_count());
}

} // namespace evod::fuzz
