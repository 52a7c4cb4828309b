// Delta codec: a picture told from the one before it, CODEC_DELTA. The layout is told in stream.proto.
//
// Both ends hold the Footing of the last picture: its entities in whole numbers, and how far those that move have moved
// to get there. The next picture is foretold by letting them move on as they did, and what travels is by how much that
// is wrong: mostly nothing or one byte. A keyframe tells the whole footing, so every viewer stands on the same one,
// whichever way it came there.
//
// The encoder is handed pictures that are right; the decoder trusts nothing: its memory follows the bytes received and
// the counts checked against them, and after damage it waits for a keyframe.
//
// Threads      a Scene and a Footing are immutable once made, and shared; a PictureDecoder is used by one thread.
// Determinism  whole numbers alone: equal pictures are equal bytes on every machine.
#pragma once

#include "evod/v1/stream.pb.h"
#include "proto/wire/result.h"
#include "proto/wire/snapshot_codec.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace evod::wire {

/// Entities of one kind, by rising id or, of boxes, in their order. Numbers are those of CODEC_COLUMNS: 1/16 px, 1/16
/// of health. All columns that a kind has are of one length; the others are empty.
struct Entities {
    std::vector<std::uint32_t> id; // organisms, food, poison
    std::vector<std::uint32_t> x, y;
    std::vector<std::uint32_t> width;  // organisms: radius; boxes: half width
    std::vector<std::uint32_t> height; // organisms: health; boxes: half height
    friend bool operator==(const Entities&, const Entities&) = default;
};

/// The entities of one picture.
struct Scene {
    std::uint32_t position_bytes = 2; // 2 or 4
    Entities organisms, food, poison, crates, obstacles;
    friend bool operator==(const Scene&, const Scene&) = default;
};

/// frame  as encode() leaves it.
Scene scene_of(const evod::v1::SnapshotFrame& frame);

/// What the next picture of an island is foretold from.
struct Footing {
    struct Displacements {
        std::vector<std::uint32_t> x, y; // two's complement; one for each entity
        friend bool operator==(const Displacements&, const Displacements&) = default;
    };
    std::shared_ptr<const Scene> scene;
    Displacements organisms, crates; // the way to here; of those that have just come, 0
    std::uint16_t ticks = 0;         // that it took
};

/// Nothing has moved yet.
Footing standing(std::shared_ptr<const Scene> scene);

/// Whether `next` can be told as a delta from `base`: their boxes are the same but for the places of crates.
bool follows(const Scene& next, const Scene& base);

/// Where an island stands `ticks` after `base`. Both ends compute it.
///
/// next  follows() base.
Footing moved_on(const Footing& base, std::shared_ptr<const Scene> next, std::uint16_t ticks);

/// The body of a keyframe.
std::string encode_keyframe(const Footing& footing);

/// The body of a delta: `next` is `ticks` after `base`, and follows() it.
std::string encode_delta(const Footing& base, const Scene& next, std::uint16_t ticks);

/// SnapshotFrame.checksum: of its sequence numbers, counts and position_bytes, and of the body before compression.
std::uint32_t checksum_of(const evod::v1::SnapshotFrame& frame, std::string_view body);

/// Leaves out what a delta does not tell.
void leave_out_unchanging(evod::v1::SnapshotFrame& frame);

/// Whether what deltas leave out is the same in both.
bool same_unchanging(const evod::v1::SnapshotFrame& a, const evod::v1::SnapshotFrame& b);

/// The pictures of one island of one subscription, one after another, by any codec.
class PictureDecoder {
  public:
    /// Damage says what is wrong; then every delta is refused up to the next keyframe.
    Result<Picture> decode(evod::v1::SnapshotFrame frame);

    /// Deltas are of no use now: there has been no keyframe yet, or damage after it.
    bool needs_keyframe() const { return !base_; }

    /// What the last picture consisted of; null before a keyframe.
    const Scene* scene() const { return base_ ? base_->footing.scene.get() : nullptr; }

  private:
    struct Base {
        Footing footing;
        evod::v1::SnapshotFrame about; // what deltas leave out, and sequence
    };
    Result<Picture> decode_delta(evod::v1::SnapshotFrame frame);

    std::optional<Base> base_;
};

} // namespace evod::wire
