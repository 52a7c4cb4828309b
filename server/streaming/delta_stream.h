// Delta stream: the snapshots of one island that all viewers of one world, rate and form receive, each encoded against
// the snapshot before it.
//
// A whole snapshot is the case of one tile that needs no tile header; a plain snapshot is the case of one tile without
// deltas. A form is encoded when the first session sends it, and only if a session sends it. The sessions share the
// bytes. Because all viewers of a group receive the same snapshots, one delta serves all of them.
//
// Owner        SnapshotStreams; a StreamedSnapshot lives until the last session has sent or replaced it.
// Threads      the network thread.
#pragma once

#include "proto/codec/delta_codec.h"
#include "proto/codec/tiles.h"
#include "server/runtime/clock.h"
#include "server/streaming/encoded_island.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::streaming {

/// At least this often all viewers are sent a keyframe, while there are snapshots.
constexpr std::chrono::seconds keyframe_interval{2};

/// Ticks from one snapshot to the next. nullopt: the next cannot be predicted from the one before, because the run, the
/// generation or an unchanging field differs, time went back, or the interval does not fit.
std::optional<std::uint16_t> ticks_between(const v1::SnapshotFrame& before, const v1::SnapshotFrame& after);

enum class Form : std::uint8_t {
    Plain, // CODEC_PLAIN
    Whole, // CODEC_DELTA
    Tiles, // CODEC_DELTA with a View
};

/// One snapshot of an island, in every encoding that viewers of one group need.
class StreamedSnapshot {
  public:
    /// previous  the snapshot before it in the stream; null: there is none. It loses its own predecessor.
    /// between   the usual time to the next snapshot.
    StreamedSnapshot(std::shared_ptr<EncodedIsland> island, Form form,
                     const std::shared_ptr<StreamedSnapshot>& previous, runtime::Clock::time_point now,
                     runtime::Clock::duration between);

    std::uint64_t sequence() const { return island_->sequence(); }
    Form form() const { return form_; }
    /// Of one tile that covers the island, unless the form is Tiles.
    const codec::TileLayout& layout() const { return layout_; }

    /// The part of a frame that precedes its tiles; null if the only tile is the whole frame.
    const SharedBytes* head();
    /// A tile for one viewer; of the forms Plain and Whole, the frame.
    ///
    /// sent  sequence of the last snapshot in which the viewer was sent this tile at DETAIL_FULL; 0: none.
    const SharedBytes& tile(std::uint32_t tile, v1::Detail detail, v1::Compression compression, std::uint64_t sent);

  private:
    enum class Encoding { Keyframe, Delta, Repeat };
    /// A tile that some viewer was sent at DETAIL_FULL.
    struct Tile {
        std::uint16_t ticks = 0;                  // duration of its displacements
        std::uint64_t base_sequence = 0;          // of `delta`; 0: the tile is a keyframe for all
        runtime::Clock::time_point keyframe_made; // when the tile was last a keyframe for all
        std::string delta;                        // body, if base_sequence is not 0
        codec::Seams delta_seams;
        std::array<std::array<SharedBytes, 2>, 3> encodings; // by Encoding: uncompressed, compressed
    };
    struct Displacements {
        std::vector<std::uint32_t> x, y; // tile after tile
    };

    Tile& full(std::uint32_t tile);
    codec::QuantisedView view(std::uint32_t tile) const;
    /// Counts of all tiles before `tile`.
    codec::Counts counts_before(std::uint32_t tile) const;
    codec::Counts counts(std::uint32_t tile) const;
    codec::BaselineView baseline(std::uint32_t tile) const;

    std::shared_ptr<EncodedIsland> island_;
    Form form_;
    codec::TileLayout layout_;
    std::shared_ptr<StreamedSnapshot> previous_; // null: no tile can be a delta
    std::uint16_t ticks_ = 0;                    // since previous_
    runtime::Clock::time_point now_;
    runtime::Clock::duration between_;
    std::vector<std::unique_ptr<Tile>> tiles_; // by index; null: no viewer was sent it
    Displacements organisms_, crates_;
};

using StreamedSnapshotPtr = std::shared_ptr<StreamedSnapshot>;

/// What one viewer was sent last of an island. It decides which tiles the viewer can be sent as deltas.
class SentState {
  public:
    /// Appends the parts of a frame: together its fields 1 to 49. They live as long as the snapshot.
    void add_parts(StreamedSnapshot& snapshot, const codec::TileRange& seen, v1::Detail detail,
                   v1::Compression compression, std::vector<const SharedBytes*>& parts) const;

    /// Records that this frame was sent.
    void sent(const StreamedSnapshot& snapshot, const codec::TileRange& seen, v1::Detail detail);

    /// The next frame will consist of keyframes.
    void reset() { *this = {}; }

  private:
    std::uint64_t sequence_ = 0;
    codec::TileRange full_; // the tiles sent at DETAIL_FULL
};

} // namespace evod::streaming
