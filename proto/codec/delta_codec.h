// Delta codec: encodes a snapshot as residuals against a baseline predicted at constant velocity, CODEC_DELTA. The layout is
// described in stream.proto.
//
// Both ends keep the Baseline of the last snapshot: its entities in whole numbers, and the displacements that led there. The
// prediction for the next snapshot continues these displacements. The body contains the residuals, which mostly take no or
// one byte each. A keyframe contains the complete baseline, so all viewers have the same baseline, whether they received
// keyframes or deltas.
//
// The encoder's input is valid. The decoder checks everything: its memory is bounded by the bytes received and the counts
// checked against them, and after damage it waits for a keyframe.
//
// Threads      a QuantisedSnapshot and a Baseline are immutable once made, and shared.
// Determinism  integers only: equal snapshots are equal bytes on every machine.
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

/// What the next snapshot of an island is predicted from.
struct Baseline {
    struct Displacements {
        Column x, y; // two's complement; one for each entity
        friend bool operator==(const Displacements&, const Displacements&) = default;
    };
    std::shared_ptr<const QuantisedSnapshot> snapshot;
    Displacements organisms, crates; // the movement that led here; 0 for entities that have just come
    std::uint16_t ticks = 0;         // duration of that movement
};

/// Views of snapshots and baselines: of those above, or of the part of longer columns that belongs to one tile.
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

/// A baseline whose displacements are 0.
Baseline initial_baseline(std::shared_ptr<const QuantisedSnapshot> snapshot);

/// Whether `next` can be a delta against `base`: the boxes are the same except for the positions of crates.
bool follows(const QuantisedView& next, const QuantisedView& base);

/// The baseline `ticks` after `base`. Both ends compute it.
///
/// next  follows() base.
Baseline advanced_baseline(const Baseline& base, std::shared_ptr<const QuantisedSnapshot> next, std::uint16_t ticks);

/// The same into existing columns, which have a 0 for each entity that moves.
struct AdvancedColumns {
    struct Displacements {
        std::span<std::uint32_t> x, y;
    };
    Displacements organisms, crates;
};
void advance_baseline(const BaselineView& base, const QuantisedView& next, std::uint16_t ticks,
                      const AdvancedColumns& to);

/// The body of a keyframe. seams: receives the seams of the body.
std::string encode_keyframe(const BaselineView& baseline, Seams* seams = nullptr);

/// The body of a delta: `next` is `ticks` after `base`, and follows() it.
///
/// to     receives what advance_baseline() would write; may be null.
/// seams  receives the seams of the body; may be null.
std::string encode_delta(const BaselineView& base, const QuantisedView& next, std::uint16_t ticks,
                         const AdvancedColumns* to = nullptr, Seams* seams = nullptr);

/// What the fields of a message say about its body.
struct BodyShape {
    Counts counts{};
    std::uint32_t position_bytes = 2;
    bool of_tile = false;
};

/// The baseline that a body describes. base: null for a keyframe.
Result<Baseline> decode_body(std::string_view body, const BodyShape& shape, const Baseline* base);

/// Size of the longest body with these counts. base: null for a keyframe.
std::uint64_t body_bytes_max(const Counts& counts, const QuantisedSnapshot* base);

/// The fields that a checksum covers besides the body.
struct ChecksummedFields {
    std::uint64_t sequence = 0, base_sequence = 0;
    Counts counts{};
    std::uint32_t position_bytes = 2;
};
/// body    before compression.
/// before  checksum of the bytes that precede these.
std::uint32_t checksum_of(const ChecksummedFields& fields, std::string_view body, std::uint32_t before = 0);
/// SnapshotFrame.checksum.
std::uint32_t checksum_of(const evod::v1::SnapshotFrame& frame, std::string_view body);

/// Clears the fields that a delta omits.
void clear_unchanging(evod::v1::SnapshotFrame& frame);

/// Whether the fields that a delta omits are equal.
bool same_unchanging(const evod::v1::SnapshotFrame& a, const evod::v1::SnapshotFrame& b);

} // namespace evod::codec
