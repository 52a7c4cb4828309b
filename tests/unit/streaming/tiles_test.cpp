#include "tests/unit/codec/living_island.h"
#include "tests/unit/streaming/viewer.h"

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

/// The snapshots of one island at one rate.
class Stream {
  public:
    explicit Stream(std::uint64_t seed, double side_px = 2000) : random_{seed} {
        island_.side_px = side_px;
        island_.populate(random_);
    }

    StreamedSnapshotPtr next(std::uint64_t ticks = 2) {
        if (ticks > 0) {
            island_.live(random_, ticks);
        }
        tick_ += ticks;
        v1::SnapshotFrame about = island_.about();
        about.set_sequence(++sequence_);
        about.set_generation_tick(tick_);
        snapshot_ = island_.snapshot();
        now_ += between;
        latest_ = std::make_shared<StreamedSnapshot>(
            std::make_shared<EncodedIsland>(std::move(about), snapshot_, compressor_), Form::Tiles, latest_, now_,
            between);
        return latest_;
    }

    /// The part of the newest snapshot that is in some tiles.
    codec::QuantisedSnapshot in(const codec::TileRange& range) const {
        const codec::TileLayout& layout = latest_->layout();
        const std::uint32_t side = layout.tile_px * 16;
        codec::QuantisedSnapshot found{.position_bytes = snapshot_.position_bytes, .of_tile = true};
        for (const auto part : codec::snapshot_parts) {
            const codec::Entities& from = snapshot_.*part;
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
    codec::QuantisedSnapshot snapshot_;
    codec::Compressor compressor_;
    Clock::time_point now_{1h};
    StreamedSnapshotPtr latest_;
};

int deltas_in(const v1::SnapshotFrame& frame) {
    return static_cast<int>(
        std::ranges::count_if(frame.tiles(), [](const auto& tile) { return tile.base_sequence() != 0; }));
}

RC_GTEST_PROP(Tiles, ViewersSeeWhatIsThereDespiteDropsAndPanning, (std::uint64_t seed)) {
    Random random{seed};
    Stream stream{seed, std::array{700.0, 2000.0, 6000.0}[below(random, 3)]};
    std::vector<Viewer> viewers;
    viewers.emplace_back(); // always sees everything
    for (int i = 0; i < 4; ++i) {
        viewers.emplace_back(i % 2 == 0 ? v1::COMPRESSION_NONE : v1::COMPRESSION_ZSTD);
    }
    std::vector<codec::TileRange> seen(viewers.size());
    for (int n = 0; n < 60; ++n) {
        const auto snapshot = stream.next(below(random, 4));
        const std::uint32_t columns = snapshot->layout().columns, rows = snapshot->layout().rows;
        for (std::size_t v = 0; v < viewers.size(); ++v) {
            seen[v] = v == 0 ? stream.everything() : seen[v];
            if (v > 0 && below(random, 4) == 0) { // it is slow, so the snapshot is dropped
                continue;
            }
            for (std::uint64_t times = v > 0 && below(random, 5) == 0 ? 3 : 1; times > 0; --times) {
                if (v > 0 && (n == 0 || below(random, 3) == 0)) { // its region changes
                    const auto from = [&](std::uint32_t end) { return static_cast<std::uint32_t>(below(random, end)); };
                    seen[v].column_begin = from(columns);
                    seen[v].column_end = seen[v].column_begin + from(columns - seen[v].column_begin + 1);
                    seen[v].row_begin = from(rows);
                    seen[v].row_end = seen[v].row_begin + from(rows - seen[v].row_begin + 1);
                }
                if (v > 0 && below(random, 20) == 0) {
                    viewers[v].request_keyframe();
                }
                if (v > 0 && below(random, 8) == 0) {
                    RC_ASSERT(viewers[v].watch(*snapshot, seen[v], v1::DETAIL_DOTS).has_value());
                    continue;
                }
                RC_ASSERT(viewers[v].watch(*snapshot, seen[v]).has_value());
                RC_ASSERT(*viewers[v].snapshot() == stream.in(seen[v]));
            }
        }
    }
}

TEST(Tiles, EveryTileIsADeltaAfterTheFirst) {
    Stream stream{1};
    Viewer viewer;
    viewer.send(*stream.next(), stream.everything());
    for (int n = 1; n < 30; ++n) {
        const auto frame = viewer.send(*stream.next(), stream.everything());
        EXPECT_EQ(deltas_in(frame), 16) << n;
    }
}

TEST(Tiles, EveryTileIsAKeyframeEveryTwoSeconds) {
    Stream stream{2};
    Viewer viewer;
    std::vector<int> age(16);
    for (int n = 0; n < 200; ++n) {
        const auto frame = viewer.send(*stream.next(), stream.everything());
        for (const auto& tile : frame.tiles()) {
            int& snapshots_ago = age[tile.tile()];
            snapshots_ago = tile.base_sequence() == 0 ? 0 : snapshots_ago + 1;
            EXPECT_LE(snapshots_ago * Stream::between, keyframe_interval);
        }
    }
}

TEST(Tiles, EachTileIsEncodedOnce) {
    Stream stream{3};
    const auto first = stream.next();
    first->tile(5, v1::DETAIL_FULL, v1::COMPRESSION_NONE, 0);
    const auto snapshot = stream.next();
    for (const auto compression : {v1::COMPRESSION_NONE, v1::COMPRESSION_ZSTD}) {
        for (const std::uint64_t sent : {std::uint64_t{0}, first->sequence(), snapshot->sequence()}) {
            EXPECT_EQ(snapshot->tile(5, v1::DETAIL_FULL, compression, sent).get(),
                      snapshot->tile(5, v1::DETAIL_FULL, compression, sent).get());
        }
        for (const auto detail : {v1::DETAIL_DOTS, v1::DETAIL_DENSITY}) {
            EXPECT_EQ(snapshot->tile(5, detail, compression, 0).get(), snapshot->tile(5, detail, compression, 0).get());
        }
    }
    EXPECT_EQ(snapshot->head()->get(), snapshot->head()->get());
}

TEST(Tiles, PanningSendsKeyframesOnlyForNewTiles) {
    Stream stream{4};
    Viewer viewer;
    const auto snapshot = stream.next();
    const codec::TileRange left{.column_begin = 0, .column_end = 2, .row_begin = 0, .row_end = 1};
    const codec::TileRange right{.column_begin = 1, .column_end = 3, .row_begin = 0, .row_end = 1};
    viewer.send(*snapshot, left);
    const auto moved = viewer.send(*snapshot, right);
    ASSERT_EQ(moved.tiles_size(), 2);
    EXPECT_EQ(moved.tiles(0).base_sequence(), snapshot->sequence());
    EXPECT_EQ(moved.tiles(1).base_sequence(), 0U);
    const auto next = viewer.send(*stream.next(), right);
    EXPECT_EQ(deltas_in(next), 2);
}

TEST(Tiles, AnotherIslandSizeStartsWithKeyframes) {
    Stream stream{5};
    Viewer viewer;
    ASSERT_TRUE(viewer.watch(*stream.next(), stream.everything()));
    stream.island().side_px = 1500;
    const auto snapshot = stream.next();
    EXPECT_EQ(deltas_in(viewer.send(*snapshot, stream.everything())), 0);
}

} // namespace
} // namespace evod::streaming
