// Delta stream: encodes the snapshots of one island for all viewers with the same world, rate and form. Each snapshot
// is encoded against the previous one.
//
// A snapshot without tiles is treated as a single tile that has no tile header. A plain snapshot is treated as a single
// tile that is never a delta. An encoding is computed when the first session sends it; all sessions share its bytes.
// All viewers of a group receive the same snapshots, so one delta serves all of them.
//
// Owner        SnapshotStreams. A StreamedSnapshot exists until the last session has sent or replaced it.
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

/// While there are snapshots, every viewer receives a keyframe at least once in this interval.
constexpr std::chrono::seconds keyframe_interval{2};

/// The number of ticks between two snapshots. nullopt: `after` cannot be predicted from `before`. Possible reasons: the
/// run, the generation or an unchanging field differs, the tick is lower, or the number does not fit into 16 bits.
std::optional<std::uint16_t> ticks_between(const v1::SnapshotFrame& before, const v1::SnapshotFrame& after);

enum class Form : std::uint8_t {
    Plain, // CODEC_PLAIN
    Whole, // CODEC_DELTA
    Tiles, // CODEC_DELTA with a View
};

/// One snapshot of an island, in all encodings that the viewers of one group need.
class StreamedSnapshot {
  public:
    /// previous  the previous snapshot in the stream; nullptr: there is none. The constructor makes it release its own
    ///           predecessor.
    /// between   the usual time between two snapshots.
    StreamedSnapshot(std::shared_ptr<EncodedIsland> island, Form form,
                     const std::shared_ptr<StreamedSnapshot>& previous, runtime::Clock::time_point now,
                     runtime::Clock::duration between);

    std::uint64_t sequence() const { return island_->sequence(); }
    Form form() const { return form_; }
    /// The tiles of the island. If the form is not Tiles, a single tile covers the island.
    const codec::TileLayout& layout() const { return layout_; }

    /// The part of a frame before its tiles; nullptr if the frame consists of one tile without a tile header.
    const SharedBytes* head();
    /// A tile for one viewer. With the forms Plain and Whole it is the whole frame.
    ///
    /// sent  sequence of the last snapshot in which the viewer received this tile at DETAIL_FULL; 0: none.
    const SharedBytes& tile(std::uint32_t tile, v1::Detail detail, v1::Compression compression, std::uint64_t sent);

    /// The memory that would be released with this snapshot: with the previous one, and with its part of the island,
    /// which other snapshots share.
    std::size_t bytes() const;

  private:
    enum class Encoding { Keyframe, Delta, Repeat };
    /// A tile that at least one viewer received at DETAIL_FULL.
    struct Tile {
        std::uint16_t ticks = 0;                  // number of ticks that the displacements cover
        std::uint64_t base_sequence = 0;          // base of `delta`; 0: the tile is a keyframe for all viewers
        runtime::Clock::time_point keyframe_made; // time when the tile was last a keyframe for all viewers
        std::string delta;                        // the body of the delta; not set if base_sequence is 0
        codec::Seams delta_seams;
        // First index: Encoding; second index: 0 uncompressed, 1 compressed.
        std::array<std::array<SharedBytes, 2>, 3> encodings;
    };
    struct Displacements {
        std::vector<std::uint32_t> x, y; // grouped by tile
    };

    Tile& full(std::uint32_t tile);
    codec::QuantisedView view(std::uint32_t tile) const;
    /// Returns the sums of the counts of all tiles with an index below `tile`.
    codec::Counts counts_before(std::uint32_t tile) const;
    codec::Counts counts(std::uint32_t tile) const;
    codec::BaselineView baseline(std::uint32_t tile) const;

    std::shared_ptr<EncodedIsland> island_;
    Form form_;
    codec::TileLayout layout_;
    std::shared_ptr<StreamedSnapshot> previous_; // nullptr: no tile can be a delta
    std::uint16_t ticks_ = 0;                    // ticks since previous_
    runtime::Clock::time_point now_;
    runtime::Clock::duration between_;
    std::vector<std::unique_ptr<Tile>> tiles_; // index: tile; nullptr: no viewer received it
    Displacements organisms_, crates_;
    SnapshotBytes held_; // everything except the island and the encodings
    std::size_t kept_encoding_bytes_ = 0;
};

using StreamedSnapshotPtr = std::shared_ptr<StreamedSnapshot>;

/// The last data of an island that one viewer received. It decides which tiles can be sent to that viewer as deltas.
class SentState {
  public:
    /// Appends the parts of a frame. Together they are its fields 1 to 49. They are valid as long as the snapshot
    /// exists.
    void add_parts(StreamedSnapshot& snapshot, const codec::TileRange& seen, v1::Detail detail,
                   v1::Compression compression, std::vector<const SharedBytes*>& parts) const;

    /// Records that a frame with these tiles was sent.
    void sent(const StreamedSnapshot& snapshot, const codec::TileRange& seen, v1::Detail detail);

    /// Makes the next frame consist of keyframes.
    void reset() { *this = {}; }
    /// Whether the next frame will consist of keyframes, because none was sent, or after reset().
    bool is_reset() const { return sequence_ == 0; }

  private:
    std::uint64_t sequence_ = 0;
    codec::TileRange full_; // the tiles sent at DETAIL_FULL
};

} // namespace evod::streaming
