// MovingSnapshots: the snapshots that a server sends of one organism that moves to the right, for tests.
#pragma once

#include "evod/v1/stream.pb.h"
#include "proto/codec/delta_codec.h"
#include "proto/codec/snapshot_codec.h"

#include <memory>

namespace evod::core {

/// Encodes keyframes, and deltas against the snapshot before, for the subscription 1.
class MovingSnapshots {
  public:
    v1::SnapshotFrame keyframe() { return next(false); }
    v1::SnapshotFrame delta() { return next(true); }

  private:
    v1::SnapshotFrame next(bool as_delta) {
        const auto x = static_cast<std::uint32_t>(sequence_) * 16;
        const auto scene = std::make_shared<const codec::QuantisedSnapshot>(
            codec::QuantisedSnapshot{.organisms = {.id = {5}, .x = {x}, .y = {16}, .width = {16}, .height = {32}}});
        v1::SnapshotFrame frame;
        frame.set_width_px(100);
        frame.set_height_px(100);
        codec::describe(*scene, frame);
        frame.set_island_count(1);
        frame.set_subscription_id(1);
        frame.set_codec(v1::CODEC_DELTA);
        frame.set_sequence(++sequence_);
        frame.set_tick(sequence_);
        const codec::Baseline baseline =
            baseline_.snapshot ? codec::advanced_baseline(baseline_, scene, 1) : codec::initial_baseline(scene);
        if (as_delta) {
            frame.set_base_sequence(sequence_ - 1);
            frame.set_body(codec::encode_delta(baseline_, *scene, 1));
            codec::clear_unchanging(frame);
        } else {
            frame.set_body(codec::encode_keyframe(baseline));
        }
        frame.set_checksum(codec::checksum_of(frame, frame.body()));
        baseline_ = baseline;
        return frame;
    }

    codec::Baseline baseline_;
    std::uint64_t sequence_ = 0;
};

} // namespace evod::core
