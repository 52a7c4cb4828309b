// Delta codec (CODEC_DELTA): encodes a snapshot as residuals against a baseline predicted at constant velocity.
// stream.proto describes the layout.
//
// Encoder and decoder both keep the Baseline of the last snapshot: its entities in whole numbers, and their
// displacements since the snapshot before it. The prediction for the next snapshot continues these displacements. The
// body contains the residuals, which usually need zero or one byte each. A keyframe contains the complete baseline. All
// viewers therefore have the same baseline, whether they received keyframes or deltas.
//
// The input of the encoder must be valid. The decoder checks everything. The received bytes, and the counts checked
// against them, bound its memory. After damage the decoder waits for a keyframe.
//
// Threads      a QuantisedSnapshot and a Baseline do not change after their creation, so threads may share them.
// Determinism  all arithmetic uses integers: equal snapshots give equal bytes on every machine.
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

/// The data from which the next snapshot of an island is predicted.
struct Baseline {
    struct Displacements {
        Column x, y; // two's complement; one number for each entity
        friend bool operator==(const Displacements&, const Displacements&) = default;
    };
    std::shared_ptr<const QuantisedSnapshot> snapshot;
    Displacements organisms, crates; // movement since the previous snapshot; 0 for new entities
    std::uint16_t ticks = 0;         // number of ticks since the previous snapshot
};

/// Non-owning views of a QuantisedSnapshot and a Baseline, or of the parts of their columns that belong to one tile.
struct EntitiesView {
    std::span<const std::uint32_t> id, x, y, width, height, heading{}, species{};
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

/// Creates a baseline in which all displacements are 0.
Baseline initial_baseline(std::shared_ptr<const QuantisedSnapshot> snapshot);

/// Returns whether `next` can be encoded as a delta against `base`. All boxes of a whole island must be the same,
/// except for the positions of crates. If both have organisms, the organisms of both or of neither must have headings,
/// and likewise species.
bool follows(const QuantisedView& next, const QuantisedView& base);

/// Returns the baseline of `next`, which is `ticks` ticks after `base`. Encoder and decoder both compute it.
///
/// next  the next snapshot; follows(next, base) must be true.
Baseline advanced_baseline(const Baseline& base, std::shared_ptr<const QuantisedSnapshot> next, std::uint16_t ticks);

/// The columns into which advance_baseline() writes. They must contain a 0 for each entity that moves.
struct AdvancedColumns {
    struct Displacements {
        std::span<std::uint32_t> x, y;
    };
    Displacements organisms, crates;
};
/// Computes the same as advanced_baseline(), but writes into existing columns.
void advance_baseline(const BaselineView& base, const QuantisedView& next, std::uint16_t ticks,
                      const AdvancedColumns& to);

/// Encodes the body of a keyframe.
///
/// seams  receives the seams of the body; may be nullptr.
std::string encode_keyframe(const BaselineView& baseline, Seams* seams = nullptr);

/// Encodes the body of a delta. `next` is `ticks` ticks after `base`, and follows(next, base) must be true.
///
/// to     receives the displacements as from advance_baseline(); may be nullptr.
/// seams  receives the seams of the body; may be nullptr.
std::string encode_delta(const BaselineView& base, const QuantisedView& next, std::uint16_t ticks,
                         const AdvancedColumns* to = nullptr, Seams* seams = nullptr);

/// The properties of a body that are stated in other fields of its message.
struct BodyShape {
    Counts counts{};
    std::uint32_t position_bytes = 2;
    bool of_tile = false;
};

/// Decodes the baseline that a body describes.
///
/// base  the baseline of a delta; nullptr for a keyframe.
Result<Baseline> decode_body(std::string_view body, const BodyShape& shape, const Baseline* base);

/// Returns the maximum size of a body with these counts.
///
/// base  the snapshot that a delta refers to; nullptr for a keyframe.
std::uint64_t body_bytes_max(const Counts& counts, const QuantisedSnapshot* base);

/// The fields that the checksum covers in addition to the body.
struct ChecksummedFields {
    std::uint64_t sequence = 0, base_sequence = 0;
    Counts counts{};
    std::uint32_t position_bytes = 2;
};
/// Computes the checksum of the fields and the body.
///
/// body    the body before compression.
/// before  the checksum of the bytes that precede the fields.
std::uint32_t checksum_of(const ChecksummedFields& fields, std::string_view body, std::uint32_t before = 0);
/// Computes SnapshotFrame.checksum.
std::uint32_t checksum_of(const evod::v1::SnapshotFrame& frame, std::string_view body);

/// Clears the fields that a delta omits if they are unchanged.
void clear_unchanging(evod::v1::SnapshotFrame& frame);

/// Returns whether two frames have equal values in the fields that a delta omits.
bool same_unchanging(const evod::v1::SnapshotFrame& a, const evod::v1::SnapshotFrame& b);

} // namespace evod::codec
