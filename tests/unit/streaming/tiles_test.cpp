#include "server/streaming/tiles.h"

#include "proto/codec/snapshot_decoder.h"
#include "tests/unit/codec/living_island.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numeric>

namespace evod::streaming {
namespace {

using namespace std::chrono_literals;
using codec::below;
using codec::LivingIsland;
using codec::Random;
using runtime::Clock;

/// A viewer at the other end of a line.
class TileViewer {
  public:
    explicit TileViewer(v1::Compression compression = v1::COMPRESSION_NONE) : compression_{compression} {}

    /// The frame that it is sent.
    v1::SnapshotFrame send(TiledSnapshot& picture, const codec::TileRange& seen, v1::Detail detail = v1::DETAIL_FULL) {
        std::vector<const SharedBytes*> parts;
        sent_.add_parts(picture, seen, detail, compression_, parts);
        sent_.sent(picture, seen, detail);
        std::string bytes;
        for (const SharedBytes* part : parts) {
            bytes += **part;
        }
        v1::SnapshotFrame frame;
        EXPECT_TRUE(frame.ParseFromString(bytes));
        return frame;
    }
    codec::Result<codec::DecodedSnapshot> watch(TiledSnapshot& picture, const codec::TileRange& seen,
                                                v1::Detail detail = v1::DETAIL_FULL) {
        return decoder_.decode(send(picture, seen, detail));
    }
    void ask_for_keyframes() { sent_.forget(); }
    const codec::QuantisedSnapshot* scene() const { return decoder_.scene(); }

  private:
    v1::Compression compression_;
    SentTiles sent_;
    codec::SnapshotDecoder decoder_;
};

/// The pictures of one island at one rate.
class Pictures {
  public:
    explicit Pictures(std::uint64_t seed, double side_px = 2000) : random_{seed} {
        island_.side_px = side_px;
        island_.populate(random_);
    }

    TiledSnapshotPtr next(std::uint64_t ticks = 2) {
        if (ticks > 0) {
            island_.live(random_, ticks);
        }
        tick_ += ticks;
        v1::SnapshotFrame about = island_.about();
        about.set_sequence(++sequence_);
        about.set_generation_tick(tick_);
        scene_ = std::make_shared<const codec::QuantisedSnapshot>(island_.scene());
        now_ += between;
        latest_ = std::make_shared<TiledSnapshot>(std::make_shared<IslandTiles>(std::move(about), scene_, compressor_),
                                                  latest_, now_, between);
        return latest_;
    }

    /// Of the newest picture, what is in some tiles.
    codec::QuantisedSnapshot in(const codec::TileRange& range) const {
        const codec::TileLayout& layout = latest_->layout();
        const std::uint32_t side = layout.tile_px * 16;
        codec::QuantisedSnapshot found{.position_bytes = scene_->position_bytes, .of_tile = true};
        for (const auto part : codec::snapshot_parts) {
            const codec::Entities& from = (*scene_).*part;
            codec::Entities& to = found.*part;
            for (std::uint32_t i = 0; i < from.x.size(); ++i) {
                const std::uint32_t column = std::min(from.x[i] / side, layout.columns - 1);
                const std::uint32_t row = std::min(from.y[i] / side, layout.rows - 1);
                if (!range.contains(layout, row * layout.columns + column)) {
                    continue;
                }
                to.id.push_back(from.id.empty() ? i : from.id[i]);
                to.x.push_back(from.x[i]);
                to.y.push_back(from.y[i]);
                if (!from.width.empty()) {
                    to.width.push_back(from.width[i]);
                    to.height.push_back(from.height[i]);
                }
            }
        }
        return found;
    }
    codec::TileRange everything() const {
        return codec::tiles_of(codec::tile_layout(island_.side_px, island_.side_px));
    }
    LivingIsland& island() { return island_; }

    static constexpr auto between = 50ms;

  private:
    Random random_;
    LivingIsland island_;
    std::uint64_t sequence_ = 0, tick_ = 0;
    std::shared_ptr<const codec::QuantisedSnapshot> scene_;
    codec::Compressor compressor_;
    Clock::time_point now_{1h};
    TiledSnapshotPtr latest_;
};

int deltas_in(const v1::SnapshotFrame& frame) {
    return static_cast<int>(
        std::ranges::count_if(frame.tiles(), [](const auto& tile) { return tile.base_sequence() != 0; }));
}

RC_GTEST_PROP(Tiles, WhateverAViewerMissesAndWhereverItLooksItSeesWhatIsThere, (std::uint64_t seed)) {
    Random random{seed};
    Pictures pictures{seed, std::array{700.0, 2000.0, 6000.0}[below(random, 3)]};
    std::vector<TileViewer> viewers;
    viewers.emplace_back(); // sees everything always
    for (int i = 0; i < 4; ++i) {
        viewers.emplace_back(i % 2 == 0 ? v1::COMPRESSION_NONE : v1::COMPRESSION_ZSTD);
    }
    std::vector<codec::TileRange> seen(viewers.size());
    for (int n = 0; n < 60; ++n) {
        const auto picture = pictures.next(below(random, 4));
        const std::uint32_t columns = picture->layout().columns, rows = picture->layout().rows;
        for (std::size_t v = 0; v < viewers.size(); ++v) {
            seen[v] = v == 0 ? pictures.everything() : seen[v];
            if (v > 0 && below(random, 4) == 0) { // it is slow, and the picture is dropped
                continue;
            }
            for (std::uint64_t times = v > 0 && below(random, 5) == 0 ? 3 : 1; times > 0; --times) {
                if (v > 0 && (n == 0 || below(random, 3) == 0)) { // it looks elsewhere
                    const auto from = [&](std::uint32_t end) { return static_cast<std::uint32_t>(below(random, end)); };
                    seen[v].column_begin = from(columns);
                    seen[v].column_end = seen[v].column_begin + from(columns - seen[v].column_begin + 1);
                    seen[v].row_begin = from(rows);
                    seen[v].row_end = seen[v].row_begin + from(rows - seen[v].row_begin + 1);
                }
                if (v > 0 && below(random, 20) == 0) {
                    viewers[v].ask_for_keyframes();
                }
                if (v > 0 && below(random, 8) == 0) {
                    RC_ASSERT(viewers[v].watch(*picture, seen[v], v1::DETAIL_DOTS).has_value());
                    continue;
                }
                RC_ASSERT(viewers[v].watch(*picture, seen[v]).has_value());
                RC_ASSERT(*viewers[v].scene() == pictures.in(seen[v]));
            }
        }
    }
}

TEST(Tiles, EveryTileIsToldFromThePictureBefore) {
    Pictures pictures{1};
    TileViewer viewer;
    viewer.send(*pictures.next(), pictures.everything());
    for (int n = 1; n < 30; ++n) {
        const auto frame = viewer.send(*pictures.next(), pictures.everything());
        EXPECT_EQ(deltas_in(frame), 16) << n;
    }
}

TEST(Tiles, EveryTileTakesAKeyframeAtLeastEveryTwoSeconds) {
    Pictures pictures{2};
    TileViewer viewer;
    std::vector<int> age(16);
    for (int n = 0; n < 200; ++n) {
        const auto frame = viewer.send(*pictures.next(), pictures.everything());
        for (const auto& tile : frame.tiles()) {
            int& pictures_ago = age[tile.tile()];
            pictures_ago = tile.base_sequence() == 0 ? 0 : pictures_ago + 1;
            EXPECT_LE(pictures_ago * Pictures::between, keyframe_interval);
        }
    }
}

TEST(Tiles, ATileIsEncodedOnceForAll) {
    Pictures pictures{3};
    const auto first = pictures.next();
    first->tile(5, v1::DETAIL_FULL, v1::COMPRESSION_NONE, 0);
    const auto picture = pictures.next();
    for (const auto compression : {v1::COMPRESSION_NONE, v1::COMPRESSION_ZSTD}) {
        for (const std::uint64_t sent : {std::uint64_t{0}, first->sequence(), picture->sequence()}) {
            EXPECT_EQ(picture->tile(5, v1::DETAIL_FULL, compression, sent).get(),
                      picture->tile(5, v1::DETAIL_FULL, compression, sent).get());
        }
        for (const auto detail : {v1::DETAIL_DOTS, v1::DETAIL_DENSITY}) {
            EXPECT_EQ(picture->tile(5, detail, compression, 0).get(), picture->tile(5, detail, compression, 0).get());
        }
    }
    EXPECT_EQ(picture->about().get(), picture->about().get());
}

TEST(Tiles, PanningShowsWhatIsNewAsKeyframesAndTheRestAsItWas) {
    Pictures pictures{4};
    TileViewer viewer;
    const auto picture = pictures.next();
    const codec::TileRange left{.column_begin = 0, .column_end = 2, .row_begin = 0, .row_end = 1};
    const codec::TileRange right{.column_begin = 1, .column_end = 3, .row_begin = 0, .row_end = 1};
    viewer.send(*picture, left);
    const auto moved = viewer.send(*picture, right);
    ASSERT_EQ(moved.tiles_size(), 2);
    EXPECT_EQ(moved.tiles(0).base_sequence(), picture->sequence());
    EXPECT_EQ(moved.tiles(1).base_sequence(), 0U);
    const auto next = viewer.send(*pictures.next(), right);
    EXPECT_EQ(deltas_in(next), 2);
}

TEST(Tiles, AnotherIslandSizeBeginsAnew) {
    Pictures pictures{5};
    TileViewer viewer;
    ASSERT_TRUE(viewer.watch(*pictures.next(), pictures.everything()));
    pictures.island().side_px = 1500;
    const auto picture = pictures.next();
    EXPECT_EQ(deltas_in(viewer.send(*picture, pictures.everything())), 0);
}

} // namespace
} // namespace evod::streaming
