// Delta codec: a picture told from the one before it, CODEC_DELTA. The layout is told in stream.proto.
//
// Both ends hold the Baseline of the last picture: its entities in whole numbers, and how far those that move have moved
// to get there. The next picture is foretold by letting them move on as they did, and what travels is by how much that
// is wrong: mostly nothing or one byte. A keyframe tells the whole baseline, so every viewer stands on the same one,
// whichever way it came there.
//
// The encoder is handed pictures that are right; the decoder trusts nothing: its memory follows the bytes received and
// the counts checked against them, and after damage it waits for a keyframe.
//
// Threads      a QuantisedSnapshot and a Baseline are immutable once made, and shared.
// Determinism  whole numbers alone: equal pictures are equal bytes on every machine.
#pragma once

#include "evod/v1/stream.pb.h"
#include "proto/codec/compression.h"
#include "proto/codec/quantised_snapshot.h"
#include "proto/codec/result.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::codec {

/// What the next picture of an island is foretold from.
struct Baseline {
    struct Displacements {
        Column x, y; // two's complement; one for each entity
        friend bool operator==(const Displacements&, const Displacements&) = default;
    };
    std::shared_ptr<const QuantisedSnapshot> snapshot;
    Displacements organisms, crates; // the way to here; of those that have just come, 0
    std::uint16_t ticks = 0;         // that it took
};

/// Scenes and baselines wherever they lie: those above, or a tile's part of longer columns.
struct EntitiesView {
    std::span<const std::uint32_t> id, x, y, width, height;
};
struct QuantisedView {
    QuantisedView() = default;
    QuantisedView(const QuantisedSnapshot& snapshot);
    std::uint32_t position_bytes = 2;
    bool of_tile = false;
    EntitiesView organisms, food, poison, crates, obstacles;
};
struct BaselineView {
    BaselineView() = default;
    BaselineView(const Baseline& baseline);
    QuantisedView snapshot;
    struct Displacements {
        std::span<const std::uint32_t> x, y;
    };
    Displacements organisms, crates;
    std::uint16_t ticks = 0;
};

/// Nothing has moved yet.
Baseline initial_baseline(std::shared_ptr<const QuantisedSnapshot> snapshot);

/// Whether `next` can be told as a delta from `base`: their boxes are the same but for the places of crates.
bool follows(const QuantisedView& next, const QuantisedView& base);

/// Where an island stands `ticks` after `base`. Both ends compute it.
///
/// next  follows() base.
Baseline advanced_baseline(const Baseline& base, std::shared_ptr<const QuantisedSnapshot> next, std::uint16_t ticks);

/// The same into columns that have a number, 0, for each that moves.
struct AdvancedColumns {
    struct Displacements {
        std::span<std::uint32_t> x, y;
    };
    Displacements organisms, crates;
};
void advance_baseline(const BaselineView& base, const QuantisedView& next, std::uint16_t ticks,
                      const AdvancedColumns& to);

/// The body of a keyframe. seams: set to those of the body.
std::string encode_keyframe(const BaselineView& baseline, Seams* seams = nullptr);

/// The body of a delta: `next` is `ticks` after `base`, and follows() it.
///
/// to     where advance_baseline() would write; null: nowhere.
/// seams  set to those of the body.
std::string encode_delta(const BaselineView& base, const QuantisedView& next, std::uint16_t ticks,
                         const AdvancedColumns* to = nullptr, Seams* seams = nullptr);

/// What the fields beside a body say of it.
struct BodyShape {
    Counts counts{};
    std::uint32_t position_bytes = 2;
    bool of_tile = false;
};

/// Where an island stands after what a body tells, which may be anything. base: what it is told from; null: a keyframe.
Result<Baseline> decode_body(std::string_view body, const BodyShape& shape, const Baseline* base);

/// The longest body that can be told with these counts. base: null of a keyframe.
std::uint64_t body_bytes_max(const Counts& counts, const QuantisedSnapshot* base);

/// What a checksum is over besides a body.
struct ChecksummedFields {
    std::uint64_t sequence = 0, base_sequence = 0;
    Counts counts{};
    std::uint32_t position_bytes = 2;
};
/// body    before it is compressed.
/// before  checksum of what comes before all this.
std::uint32_t checksum_of(const ChecksummedFields& told, std::string_view body, std::uint32_t before = 0);
/// SnapshotFrame.checksum.
std::uint32_t checksum_of(const evod::v1::SnapshotFrame& frame, std::string_view body);

/// Leaves out what a delta does not tell.
void clear_unchanging(evod::v1::SnapshotFrame& frame);

/// Whether what deltas leave out is the same in both.
bool same_unchanging(const evod::v1::SnapshotFrame& a, const evod::v1::SnapshotFrame& b);

} // namespace evod::codec
