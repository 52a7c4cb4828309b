#include "server/streaming/delta_stream.h"

#include "proto/codec/snapshot_decoder.h"

#include <gtest/gtest.h>

#include <utility>

namespace evod::streaming {
namespace {

using namespace std::chrono_literals;
using runtime::Clock;

class DeltaStreamTest : public testing::Test {
  protected:
    /// Adds a picture of what `frame_` tells, `between` after the last.
    DeltaSnapshotPtr add(Clock::duration between = 100ms) {
        const auto x = static_cast<std::uint32_t>(frame_.generation_tick()) * 16;
        codec::QuantisedSnapshot scene{
            .organisms = {.id = {1, 2}, .x = {x, x}, .y = {16, 16}, .width = {16, 16}, .height = {1600, 1600}}};
        frame_.set_width_px(100);
        frame_.set_height_px(100);
        codec::describe(scene, frame_);
        frame_.set_island_count(1);
        frame_.set_sequence(frame_.sequence() + 1);
        now_ += between;
        return chain_.add(std::make_shared<const v1::SnapshotFrame>(frame_),
                          std::make_shared<const codec::QuantisedSnapshot>(std::move(scene)), compressor_, now_,
                          between);
    }
    DeltaSnapshotPtr add_next() {
        frame_.set_generation_tick(frame_.generation_tick() + 6);
        return add();
    }

    static v1::SnapshotFrame frame_of(const SharedBytes& bytes) {
        v1::SnapshotFrame frame;
        EXPECT_TRUE(frame.ParseFromString(*bytes));
        return frame;
    }

    v1::SnapshotFrame frame_;
    codec::Compressor compressor_;
    Clock::time_point now_{1h};
    DeltaStream chain_;
};

TEST_F(DeltaStreamTest, EveryPictureButTheFirstIsToldFromTheOneBefore) {
    EXPECT_EQ(add()->base_sequence(), 0U);
    for (std::uint64_t sequence = 2; sequence < 10; ++sequence) {
        const auto picture = add_next();
        EXPECT_EQ(picture->sequence(), sequence);
        EXPECT_EQ(picture->base_sequence(), sequence - 1);
    }
}

TEST_F(DeltaStreamTest, EachFormIsMadeOnce) {
    add();
    const auto picture = add_next();
    for (const auto compression : {v1::COMPRESSION_NONE, v1::COMPRESSION_ZSTD}) {
        EXPECT_EQ(picture->delta(compression).get(), picture->delta(compression).get());
        EXPECT_EQ(picture->keyframe(compression).get(), picture->keyframe(compression).get());
    }
    EXPECT_NE(picture->delta(v1::COMPRESSION_NONE), picture->keyframe(v1::COMPRESSION_NONE));
}

TEST_F(DeltaStreamTest, AViewerOfDeltasAndOneOfKeyframesSeeTheSame) {
    codec::SnapshotDecoder of_deltas, of_keyframes;
    ASSERT_TRUE(of_deltas.decode(frame_of(add()->keyframe(v1::COMPRESSION_ZSTD))));
    for (int i = 0; i < 5; ++i) {
        const auto picture = add_next();
        ASSERT_TRUE(of_deltas.decode(frame_of(picture->delta(v1::COMPRESSION_ZSTD))));
        ASSERT_TRUE(of_keyframes.decode(frame_of(picture->keyframe(v1::COMPRESSION_NONE))));
        EXPECT_EQ(*of_deltas.scene(), *of_keyframes.scene());
    }
    EXPECT_TRUE(of_keyframes.decode(frame_of(add_next()->delta(v1::COMPRESSION_NONE)))) << "it may go on with deltas";
}

TEST_F(DeltaStreamTest, AKeyframeForAllComesAtLeastEveryTwoSeconds) {
    auto last_keyframe = now_;
    for (int i = 0; i < 100; ++i) {
        const auto picture = add_next();
        if (picture->base_sequence() == 0) {
            EXPECT_LE(now_ - last_keyframe, keyframe_interval);
            EXPECT_TRUE(i == 0 || now_ - last_keyframe > keyframe_interval - 2 * 100ms);
            last_keyframe = now_;
        }
    }
    EXPECT_LE(now_ - last_keyframe, keyframe_interval);
}

TEST_F(DeltaStreamTest, AtALowRateEveryPictureIsAKeyframe) {
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(add(3s)->base_sequence(), 0U);
    }
}

TEST_F(DeltaStreamTest, WhatCannotBeForetoldBeginsAnew) {
    add();
    const std::vector<void (*)(v1::SnapshotFrame&)> changes{
        [](v1::SnapshotFrame& frame) { frame.set_run_id("another"); },
        [](v1::SnapshotFrame& frame) { frame.set_generation(frame.generation() + 1); },
        [](v1::SnapshotFrame& frame) { frame.set_item_radius_px(7); },
        [](v1::SnapshotFrame& frame) { frame.set_generation_tick(frame.generation_tick() - 1); },
        [](v1::SnapshotFrame& frame) { frame.set_generation_tick(frame.generation_tick() + 70'000); }};
    for (const auto& change : changes) {
        EXPECT_GT(add_next()->base_sequence(), 0U);
        change(frame_);
        EXPECT_EQ(add()->base_sequence(), 0U);
    }
}

TEST_F(DeltaStreamTest, WhatWouldNotBecomeSmallerIsNotCompressed) {
    add();
    const auto frame = frame_of(add_next()->delta(v1::COMPRESSION_ZSTD));
    EXPECT_EQ(frame.compression(), v1::COMPRESSION_UNSPECIFIED);
    EXPECT_LT(frame.body().size(), 20U);
}

} // namespace
} // namespace evod::streaming
