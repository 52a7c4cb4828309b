#include "proto/codec/tiles.h"

#include "proto/codec/body.h"
#include "proto/codec/compression.h"
#include "proto/codec/snapshot_decoder.h"
#include "tests/unit/codec/living_island.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>
#include <numeric>

namespace evod::codec {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

evod::v1::Region region(double left_px, double top_px, double width_px, double height_px) {
    evod::v1::Region region;
    region.set_left_px(left_px);
    region.set_top_px(top_px);
    region.set_width_px(width_px);
    region.set_height_px(height_px);
    return region;
}

TEST(TileLayout, HasTheSmallestAllowedTiles) {
    const TileLayout small = tile_layout(800, 600);
    EXPECT_EQ((std::array{small.tile_px, small.columns, small.rows}), (std::array{512U, 2U, 2U}));
    EXPECT_EQ(tile_layout(512, 512).count(), 1U);
    EXPECT_EQ(tile_layout(512.5, 1).count(), 2U);
    EXPECT_EQ(tile_layout(32 * 512, 32 * 512).tile_px, 512U);
    EXPECT_EQ(tile_layout(32 * 512 + 1, 32 * 512).tile_px, 1024U);
    for (const double side : {1.0, 16'384.0, 30'000.0, 286'000.0, 1e8}) {
        EXPECT_LE(tile_layout(side, side / 3).count(), tiles_max);
    }
}

TEST(TileRange, ContainsTheTilesThatARegionTouches) {
    const TileLayout layout = tile_layout(2000, 1100); // 4 columns, 3 rows
    const auto tiles = [&](const evod::v1::Region& of) {
        std::vector<std::uint32_t> found;
        const TileRange range = tiles_of(of, layout);
        range.each(layout, [&](std::uint32_t tile) {
            EXPECT_TRUE(range.contains(layout, tile));
            found.push_back(tile);
        });
        return found;
    };
    EXPECT_THAT(tiles(region(0, 0, 512, 512)), ElementsAre(0));
    EXPECT_THAT(tiles(region(0, 0, 513, 512)), ElementsAre(0, 1));
    EXPECT_THAT(tiles(region(511, 511, 2, 2)), ElementsAre(0, 1, 4, 5));
    EXPECT_THAT(tiles(region(512, 512, 1, 1)), ElementsAre(5));
    EXPECT_THAT(tiles(region(1999, 1099, 1e300, 1e300)), ElementsAre(11));
    EXPECT_EQ(tiles(region(-1e300, -1e300, 1.5e308, 1.5e308)).size(), 12U);
    EXPECT_EQ(tiles(region(-1e308, -1e308, 1.7e308, 1.7e308)).size(), 12U) << "sums beyond all numbers too";
    for (const auto& outside :
         {region(-10, 0, 10, 10), region(0, -10, 10, 10), region(2000, 0, 1, 1), region(0, 1100, 1, 1)}) {
        EXPECT_EQ(tiles_of(outside, layout), TileRange{});
    }
    EXPECT_EQ(tiles_of(layout), tiles_of(region(0, 0, 2000, 1100), layout));
}

/// A snapshot as tiles contain it: its boxes have ids.
QuantisedSnapshot with_ids(QuantisedSnapshot snapshot) {
    snapshot.of_tile = true;
    for (Entities* boxes : {&snapshot.crates, &snapshot.obstacles}) {
        boxes->id.resize(boxes->x.size());
        std::iota(boxes->id.begin(), boxes->id.end(), 0U);
    }
    return snapshot;
}

QuantisedSnapshot copy_of(const QuantisedView& view) {
    const auto copy = [](const EntitiesView& of) {
        return Entities{.id = {of.id.begin(), of.id.end()},
                        .x = {of.x.begin(), of.x.end()},
                        .y = {of.y.begin(), of.y.end()},
                        .width = {of.width.begin(), of.width.end()},
                        .height = {of.height.begin(), of.height.end()},
                        .heading = {of.heading.begin(), of.heading.end()},
                        .species = {of.species.begin(), of.species.end()}};
    };
    return {.position_bytes = view.position_bytes,
            .of_tile = view.of_tile,
            .organisms = copy(view.organisms),
            .food = copy(view.food),
            .poison = copy(view.poison),
            .crates = copy(view.crates),
            .obstacles = copy(view.obstacles)};
}

LivingIsland random_island(std::uint64_t seed) {
    Random random{seed};
    LivingIsland island;
    island.headings = below(random, 2) == 0;
    island.species = below(random, 2) == 0;
    island.side_px = std::array{400.0, 1024.0, 4000.0, 60'000.0}[below(random, 4)];
    island.populate(random);
    island.live(random, 1); // some are on the walls
    return island;
}

TEST(SnapshotTiles, HeadingsInSomeTilesOnlyAreRefused) {
    QuantisedSnapshot with{.of_tile = true}, without{.of_tile = true};
    with.organisms = {.id = {1}, .x = {1}, .y = {1}, .width = {1}, .height = {1}, .heading = {9}};
    without.organisms = {.id = {2}, .x = {2}, .y = {2}, .width = {2}, .height = {2}};
    const QuantisedSnapshot empty{.of_tile = true};
    EXPECT_THAT(merged(2, std::array<const QuantisedSnapshot*, 2>{&with, &empty}).value().organisms.heading,
                ElementsAre(9));
    const auto refused = merged(2, std::array<const QuantisedSnapshot*, 2>{&with, &without});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().what, HasSubstr("headings only in some tiles"));
}

TEST(SnapshotTiles, SpeciesInSomeTilesOnlyAreRefused) {
    QuantisedSnapshot with{.of_tile = true}, without{.of_tile = true};
    with.organisms = {.id = {1}, .x = {1}, .y = {1}, .width = {1}, .height = {1}, .species = {1}};
    without.organisms = {.id = {2}, .x = {2}, .y = {2}, .width = {2}, .height = {2}};
    const auto refused = merged(2, std::array<const QuantisedSnapshot*, 2>{&with, &without});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().what, HasSubstr("species only in some tiles"));
}

RC_GTEST_PROP(SnapshotTiles, AllTilesTogetherAreTheSnapshot, (std::uint64_t seed)) {
    const LivingIsland island = random_island(seed);
    const auto snapshot = std::make_shared<const QuantisedSnapshot>(island.snapshot());
    SnapshotTiles tiled{snapshot, tile_layout(island.side_px, island.side_px)};
    const std::uint32_t side = tiled.layout().tile_px * 16;
    std::vector<QuantisedSnapshot> tiles;
    Counts counts{};
    for (std::uint32_t tile = 0; tile < tiled.layout().count(); ++tile) {
        tiles.push_back(copy_of(tiled.full(tile)));
        RC_ASSERT(counts_of(tiles.back()) == tiled.counts(tile));
        for (std::size_t p = 0; p < counts.size(); ++p) {
            counts[p] += tiled.counts(tile)[p];
            const Entities& entities = tiles.back().*snapshot_parts[p];
            for (std::size_t i = 0; i < entities.x.size(); ++i) {
                RC_ASSERT(tile == std::min(entities.y[i] / side, tiled.layout().rows - 1) * tiled.layout().columns +
                                      std::min(entities.x[i] / side, tiled.layout().columns - 1));
            }
        }
    }
    RC_ASSERT(counts == counts_of(*snapshot));
    std::vector<const QuantisedSnapshot*> pointers;
    for (const QuantisedSnapshot& tile : tiles) {
        pointers.push_back(&tile);
    }
    const auto together = merged(snapshot->position_bytes, pointers);
    RC_ASSERT(together.has_value());
    RC_ASSERT(*together == with_ids(*snapshot));
}

RC_GTEST_PROP(SnapshotTiles, DotsAndDensitiesMatchACount, (std::uint64_t seed)) {
    const LivingIsland island = random_island(seed);
    const auto snapshot = std::make_shared<const QuantisedSnapshot>(island.snapshot());
    SnapshotTiles tiled{snapshot, tile_layout(island.side_px, island.side_px)};
    const TileLayout& layout = tiled.layout();
    for (std::uint32_t tile = 0; tile < layout.count(); ++tile) {
        const auto dots = decode_dots(tiled.dots(tile), tiled.counts(tile), layout, tile);
        const auto density = decode_density(tiled.density(tile), tiled.counts(tile));
        RC_ASSERT(dots.has_value());
        RC_ASSERT(density.has_value());
        const QuantisedSnapshot full = copy_of(tiled.full(tile));
        const std::array places{&dots->organisms, &dots->food, &dots->poison, &dots->crates, &dots->obstacles};
        const std::array cells{&density->organisms, &density->food, &density->poison};
        const double left_px = tile % layout.columns * double{1} * layout.tile_px;
        const double top_px = tile / layout.columns * double{1} * layout.tile_px;
        for (std::size_t p = 0; p < places.size(); ++p) {
            const Entities& entities = full.*snapshot_parts[p];
            RC_ASSERT(places[p]->x_px.size() == entities.x.size());
            const double half_dot_px = layout.tile_px / 512.0;
            std::vector<std::uint32_t> counted(std::size_t{density->cells_per_side} * density->cells_per_side);
            for (std::size_t i = 0; i < entities.x.size(); ++i) {
                RC_ASSERT(std::abs(places[p]->x_px[i] - entities.x[i] / 16.0) <= half_dot_px);
                RC_ASSERT(std::abs(places[p]->y_px[i] - entities.y[i] / 16.0) <= half_dot_px);
                const double cell_px = double{1} * layout.tile_px / density->cells_per_side;
                const auto cell = [&](double px) { // an entity on a wall is in the last cell before it
                    return std::min(static_cast<std::uint32_t>(px / cell_px), density->cells_per_side - 1);
                };
                ++counted[cell(entities.y[i] / 16.0 - top_px) * density->cells_per_side +
                          cell(entities.x[i] / 16.0 - left_px)];
            }
            if (p < cells.size()) {
                RC_ASSERT(*cells[p] == counted);
            }
        }
    }
}

TEST(Density, TakesHalfTheBytesOfManyDots) {
    Random random{1};
    LivingIsland island;
    while (island.organisms.size() < 4000) {
        island.add_organism(random);
    }
    SnapshotTiles tiled{std::make_shared<const QuantisedSnapshot>(island.snapshot()),
                        tile_layout(island.side_px, island.side_px)};
    std::size_t dots = 0, densities = 0;
    for (std::uint32_t tile = 0; tile < tiled.layout().count(); ++tile) {
        dots += tiled.dots(tile).size();
        densities += tiled.density(tile).size();
    }
    EXPECT_LT(densities, dots / 2);
}

// ---- decoding --------------------------------------------------------------------------------------------------

/// A frame of all tiles; the detail of each depends on its index.
evod::v1::SnapshotFrame frame_of(const LivingIsland& island, std::uint64_t sequence) {
    SnapshotTiles tiled{std::make_shared<const QuantisedSnapshot>(island.snapshot()),
                        tile_layout(island.side_px, island.side_px)};
    evod::v1::SnapshotFrame frame = island.about();
    frame.set_codec(evod::v1::CODEC_DELTA);
    frame.set_sequence(sequence);
    frame.set_tile_px(tiled.layout().tile_px);
    for (std::uint32_t index = 0; index < tiled.layout().count(); ++index) {
        auto& tile = *frame.add_tiles();
        tile.set_tile(index);
        tile.set_detail(static_cast<evod::v1::Detail>(evod::v1::DETAIL_FULL + index % 3));
        const Counts counts = tiled.counts(index);
        tile.set_organism_count(counts[0]);
        tile.set_food_count(counts[1]);
        tile.set_poison_count(counts[2]);
        tile.set_crate_count(counts[3]);
        tile.set_obstacle_count(counts[4]);
        tile.set_sequence(sequence);
        tile.set_body(index % 3 == 0 ? encode_keyframe(initial_baseline(
                                           std::make_shared<const QuantisedSnapshot>(copy_of(tiled.full(index)))))
                                     : (index % 3 == 1 ? tiled.dots(index) : tiled.density(index)));
        tile.set_checksum(checksum_of(frame.tile_px(), frame.position_bytes(), tile, tile.body()));
    }
    return frame;
}

evod::v1::SnapshotFrame some_frame() {
    Random random{4};
    LivingIsland island;
    island.populate(random);
    return frame_of(island, 7);
}

/// Corrects the checksum after a change.
void mend(const evod::v1::SnapshotFrame& frame, evod::v1::SnapshotTile& tile) {
    tile.set_checksum(checksum_of(frame.tile_px(), frame.position_bytes(), tile, tile.body()));
}

TEST(TiledFrame, IsDecodedTileByTile) {
    const auto frame = some_frame();
    SnapshotDecoder decoder;
    const auto decoded = decoder.decode(frame);
    ASSERT_TRUE(decoded) << decoded.error().what;
    EXPECT_FALSE(decoder.needs_keyframe());
    ASSERT_EQ(decoded->tiles.size(), 64U);
    EXPECT_EQ(decoded->tiles[9].left_px, 512);
    EXPECT_EQ(decoded->tiles[9].top_px, 512);
    EXPECT_EQ(decoded->about.tiles_size(), 0);
    std::size_t shown = decoded->entities->organisms.id.size();
    for (const DecodedTile& tile : decoded->tiles) {
        shown += tile.dots.organisms.x_px.size();
        shown += std::accumulate(tile.density.organisms.begin(), tile.density.organisms.end(), std::size_t{0});
    }
    EXPECT_GT(shown, decoded->entities->organisms.id.size());
    EXPECT_EQ(shown, frame.organism_count());
}

TEST(TiledFrame, MayHaveNoTiles) {
    auto frame = some_frame();
    frame.clear_tiles();
    const auto decoded = SnapshotDecoder{}.decode(frame);
    ASSERT_TRUE(decoded);
    EXPECT_TRUE(decoded->tiles.empty());
    EXPECT_TRUE(decoded->entities->organisms.id.empty());
}

TEST(TiledFrameDamage, EveryOtherByteOfATileIsRefused) {
    const auto frame = some_frame();
    for (const int index : {0, 1, 2}) {
        const std::size_t length = frame.tiles(index).body().size();
        ASSERT_GT(length, 1U);
        for (std::size_t i = 0; i < length; ++i) {
            auto damaged = frame;
            auto& body = *damaged.mutable_tiles(index)->mutable_body();
            body[i] = static_cast<char>(body[i] ^ 0x10);
            SnapshotDecoder decoder;
            ASSERT_TRUE(decoder.decode(frame));
            const auto decoded = decoder.decode(damaged);
            ASSERT_FALSE(decoded) << i;
            EXPECT_THAT(decoded.error().what, HasSubstr("checksum"));
            EXPECT_TRUE(decoder.needs_keyframe()) << "the whole decoded is refused";
        }
    }
    // The checksum covers index and detail of the tile too.
    for (const auto change : std::vector<void (*)(evod::v1::SnapshotFrame&)>{
             [](auto& of) { of.mutable_tiles(63)->set_detail(evod::v1::DETAIL_DENSITY); },
             [](auto& of) { of.set_tile_px(256); },
             [](auto& of) {
                 of.mutable_tiles()->DeleteSubrange(10, 1);
                 of.mutable_tiles(9)->set_tile(10);
             }}) {
        auto damaged = frame;
        change(damaged);
        EXPECT_FALSE(SnapshotDecoder{}.decode(damaged));
    }
}

TEST(TiledFrameDamage, IsRefusedDespiteARightChecksum) {
    const auto frame = some_frame();
    const auto refused = [&](int index, const char* why, const auto& change) {
        auto damaged = frame;
        change(damaged, *damaged.mutable_tiles(index));
        mend(damaged, *damaged.mutable_tiles(index));
        const auto decoded = SnapshotDecoder{}.decode(damaged);
        ASSERT_FALSE(decoded) << why;
        EXPECT_THAT(decoded.error().what, HasSubstr(why));
    };
    using Frame = evod::v1::SnapshotFrame;
    using Tile = evod::v1::SnapshotTile;
    refused(63, "a tile's index is 64, not one of 64", [](Frame&, Tile& tile) { tile.set_tile(64); });
    refused(63, "out of order", [](Frame&, Tile& tile) { tile.set_tile(62); });
    refused(3, "sequence", [](Frame&, Tile& tile) { tile.set_sequence(6); });
    refused(3, "keyframe", [](Frame&, Tile& tile) { tile.set_base_sequence(6); });
    refused(3, "detail is 9", [](Frame&, Tile& tile) { tile.set_detail(static_cast<evod::v1::Detail>(9)); });
    refused(3, "compression is 9",
            [](Frame&, Tile& tile) { tile.set_compression(static_cast<evod::v1::Compression>(9)); });
    refused(3, "adds more entities", [](Frame&, Tile& tile) {
        tile.set_organism_count(0xffffffff);
        tile.set_body(std::string("\0\0\2\xff\xff\xff\xff\0\0\0\0", 11));
    });
    refused(1, "as its counts say", [](Frame&, Tile& tile) { tile.set_organism_count(0xffffffff); });
    refused(1, "as its counts say", [](Frame&, Tile& tile) { tile.mutable_body()->push_back('x'); });
    refused(2, "cells per row", [](Frame&, Tile& tile) { tile.mutable_body()->front() = 3; });
    refused(2, "cells per row", [](Frame&, Tile& tile) { tile.mutable_body()->front() = 32; });
    refused(2, "surplus bytes", [](Frame&, Tile& tile) { tile.mutable_body()->push_back(0); });
    refused(2, "do not add up to the counts", [](Frame&, Tile& tile) { tile.set_food_count(tile.food_count() + 1); });
    refused(0, "power of two", [](Frame& of, Tile&) { of.set_tile_px(500); });
    refused(0, "too small", [](Frame& of, Tile&) { of.set_width_px(1e300); });
    refused(0, "width_px", [](Frame& of, Tile&) { of.set_width_px(std::nan("")); });
    refused(3, "in two tiles", [](Frame& of, Tile& tile) { // the same entities in another tile
        const int full = of.tiles(0).food_count() > 0 ? 0 : 6;
        const Tile from = of.tiles(full);
        tile = from;
        tile.set_tile(3);
    });
}

TEST(TiledFrameDamage, AllTilesShareTheLimitOfAFrame) {
    // Each is slightly more than a quarter of the limit of a frame, of zeros that compress well.
    auto frame = some_frame();
    Compressor compressor;
    const std::string zeros = compressor.compress(std::string(70 << 20, '\0'));
    for (int index : {1, 4, 7, 10}) {
        auto& tile = *frame.mutable_tiles(index);
        tile.set_organism_count(35 << 20);
        tile.set_food_count(0);
        tile.set_poison_count(0);
        tile.set_crate_count(0);
        tile.set_obstacle_count(0);
        tile.set_compression(evod::v1::COMPRESSION_ZSTD);
        tile.set_body(zeros);
        tile.set_checksum(checksum_of(frame.tile_px(), frame.position_bytes(), tile, std::string(70 << 20, '\0')));
    }
    const auto decoded = SnapshotDecoder{}.decode(frame);
    ASSERT_FALSE(decoded);
    EXPECT_THAT(decoded.error().what, HasSubstr("has 73400320 bytes of content"));
}

} // namespace
} // namespace evod::codec
