#include "server/streaming/delta_stream.h"

#include "tests/unit/streaming/viewer.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace evod::streaming {
namespace {

using namespace std::chrono_literals;
using runtime::Clock;

class DeltaStreamTest : public testing::Test {
  protected:
    /// Adds a snapshot at frame_.generation_tick(), `between` after the last.
    StreamedSnapshotPtr add(Clock::duration between = 100ms, Form form = Form::Whole) {
        const auto x = static_cast<std::uint32_t>(frame_.generation_tick()) * 16;
        codec::QuantisedSnapshot snapshot{
            .organisms = {.id = {1, 2}, .x = {x, x}, .y = {16, 16}, .width = {16, 16}, .height = {1600, 1600}}};
        frame_.set_width_px(100);
        frame_.set_height_px(100);
        frame_.set_island_count(1);
        frame_.set_sequence(frame_.sequence() + 1);
        now_ += between;
        auto island = std::make_shared<EncodedIsland>(frame_, std::move(snapshot), compressor_);
        return latest_ = std::make_shared<StreamedSnapshot>(std::move(island), form, latest_, now_, between);
    }
    StreamedSnapshotPtr add_next() {
        frame_.set_generation_tick(frame_.generation_tick() + 6);
        return add();
    }

    v1::SnapshotFrame frame_;
    codec::Compressor compressor_;
    Clock::time_point now_{1h};
    StreamedSnapshotPtr latest_;
};

TEST_F(DeltaStreamTest, EverySnapshotAfterTheFirstIsADelta) {
    Viewer viewer;
    EXPECT_EQ(viewer.send(*add()).base_sequence(), 0U);
    for (std::uint64_t sequence = 2; sequence < 10; ++sequence) {
        const auto frame = viewer.send(*add_next());
        EXPECT_EQ(frame.sequence(), sequence);
        EXPECT_EQ(frame.base_sequence(), sequence - 1);
    }
}

TEST_F(DeltaStreamTest, EachFormIsEncodedOnce) {
    const auto first = add();
    first->tile(0, v1::DETAIL_FULL, v1::COMPRESSION_NONE, 0);
    const auto snapshot = add_next();
    const auto bytes = [&](v1::Compression compression, std::uint64_t sent) {
        return snapshot->tile(0, v1::DETAIL_FULL, compression, sent).get();
    };
    for (const auto compression : {v1::COMPRESSION_NONE, v1::COMPRESSION_ZSTD}) {
        for (const std::uint64_t sent : {std::uint64_t{0}, first->sequence()}) {
            EXPECT_EQ(bytes(compression, sent), bytes(compression, sent));
        }
    }
    EXPECT_NE(bytes(v1::COMPRESSION_NONE, 0), bytes(v1::COMPRESSION_NONE, first->sequence()));
}

TEST_F(DeltaStreamTest, KeyframesAndDeltasShowTheSame) {
    Viewer of_deltas{v1::COMPRESSION_ZSTD}, of_keyframes;
    ASSERT_TRUE(of_deltas.watch(*add()));
    for (int i = 0; i < 5; ++i) {
        const auto snapshot = add_next();
        of_keyframes.request_keyframe();
        ASSERT_TRUE(of_deltas.watch(*snapshot));
        ASSERT_TRUE(of_keyframes.watch(*snapshot));
        EXPECT_EQ(*of_deltas.snapshot(), *of_keyframes.snapshot());
    }
    const auto frame = of_keyframes.send(*add_next());
    EXPECT_GT(frame.base_sequence(), 0U) << "it may continue with deltas";
    EXPECT_TRUE(of_keyframes.decode(frame));
}

TEST_F(DeltaStreamTest, AKeyframeForAllComesEveryTwoSeconds) {
    Viewer viewer;
    auto last_keyframe = now_;
    for (int i = 0; i < 100; ++i) {
        if (viewer.send(*add_next()).base_sequence() == 0) {
            EXPECT_LE(now_ - last_keyframe, keyframe_interval);
            EXPECT_TRUE(i == 0 || now_ - last_keyframe > keyframe_interval - 2 * 100ms);
            last_keyframe = now_;
        }
    }
    EXPECT_LE(now_ - last_keyframe, keyframe_interval);
}

TEST_F(DeltaStreamTest, AtALowRateEverySnapshotIsAKeyframe) {
    Viewer viewer;
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(viewer.send(*add(3s)).base_sequence(), 0U);
    }
}

TEST_F(DeltaStreamTest, UnpredictableChangesStartWithAKeyframe) {
    Viewer viewer;
    viewer.send(*add());
    const std::vector<void (*)(v1::SnapshotFrame&)> changes{
        [](v1::SnapshotFrame& frame) { frame.set_run_id("another"); },
        [](v1::SnapshotFrame& frame) { frame.set_generation(frame.generation() + 1); },
        [](v1::SnapshotFrame& frame) { frame.set_item_radius_px(7); },
        [](v1::SnapshotFrame& frame) { frame.set_generation_tick(frame.generation_tick() - 1); },
        [](v1::SnapshotFrame& frame) { frame.set_generation_tick(frame.generation_tick() + 70'000); }};
    for (const auto& change : changes) {
        EXPECT_GT(viewer.send(*add_next()).base_sequence(), 0U);
        change(frame_);
        EXPECT_EQ(viewer.send(*add()).base_sequence(), 0U);
    }
}

TEST_F(DeltaStreamTest, BodiesThatWouldGrowAreNotCompressed) {
    Viewer viewer{v1::COMPRESSION_ZSTD};
    viewer.send(*add());
    const auto frame = viewer.send(*add_next());
    EXPECT_EQ(frame.compression(), v1::COMPRESSION_UNSPECIFIED);
    EXPECT_LT(frame.body().size(), 20U);
}

TEST_F(DeltaStreamTest, EveryPlainSnapshotIsComplete) {
    Viewer viewer;
    for (int i = 0; i < 3; ++i) {
        frame_.set_generation_tick(frame_.generation_tick() + 6);
        const auto decoded = viewer.watch(*add(100ms, Form::Plain));
        ASSERT_TRUE(decoded);
        EXPECT_EQ(decoded->entities->organisms.id, (codec::Column{1, 2}));
        EXPECT_EQ(decoded->entities->organisms.x,
                  codec::Column(2, static_cast<std::uint32_t>(16 * frame_.generation_tick())));
        EXPECT_EQ(decoded->about.base_sequence(), 0U);
    }
}

} // namespace
} // namespace evod::streaming
