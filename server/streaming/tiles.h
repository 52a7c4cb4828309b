// Tiled pictures: what viewers with a View are sent, tile by tile.
//
// A frame is put together from bytes that all share: what it is about, and each tile in the form that the viewer can
// take. Nothing is encoded for one viewer alone, and nothing for a tile that nobody is sent.
//
// Owner        Streams; a picture lives as long as a session is to send it.
// Threads      the network thread.
#pragma once

#include "proto/codec/compression.h"
#include "proto/codec/shared_bytes.h"
#include "proto/codec/tiles.h"
#include "server/runtime/clock.h"
#include "server/streaming/delta_stream.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace evod::streaming {

/// An island cut into tiles at one moment: what all viewers share, whatever their rates.
class IslandTiles {
  public:
    /// about       all of the frame but its tiles.
    /// compressor  there as long as tiles are asked for.
    IslandTiles(v1::SnapshotFrame about, std::shared_ptr<const codec::QuantisedSnapshot> scene,
                codec::Compressor& compressor);

    const v1::SnapshotFrame& about() const { return about_; }
    codec::SnapshotTiles& scene() { return scene_; }

    /// Fields 1 to 49 but for the tiles.
    const SharedBytes& about_bytes();
    /// One of the frame's `tiles`: all of SnapshotTile but what is not the same at every detail and rate is set here.
    SharedBytes encode(v1::SnapshotTile tile, std::string_view body, const codec::Seams& seams,
                       v1::Compression compression);
    /// A tile at DETAIL_DOTS or DETAIL_DENSITY.
    const SharedBytes& coarse(std::uint32_t tile, v1::Detail detail, v1::Compression compression);

  private:
    codec::SnapshotTiles scene_;
    v1::SnapshotFrame about_;
    codec::Compressor* compressor_;
    SharedBytes about_bytes_;
    std::vector<std::array<SharedBytes, 4>> coarse_; // by tile: dots and densities, as they are and compressed
};

/// One picture of an island in tiles, for the viewers of its world at one rate.
///
/// A tile is told from the picture before if somebody was sent it of that: otherwise nobody could take the delta.
class TiledSnapshot {
  public:
    /// before   the picture before it at this rate; null: there is none.
    /// between  how long it usually is to the next picture.
    TiledSnapshot(std::shared_ptr<IslandTiles> island, const std::shared_ptr<TiledSnapshot>& before,
                  runtime::Clock::time_point now, runtime::Clock::duration between);

    std::uint64_t sequence() const { return island_->about().sequence(); }
    const codec::TileLayout& layout() const { return island_->scene().layout(); }
    const SharedBytes& about() { return island_->about_bytes(); }

    /// A tile for a viewer. sent: the picture in which it was sent this tile at DETAIL_FULL last; 0: in none.
    const SharedBytes& tile(std::uint32_t tile, v1::Detail detail, v1::Compression compression, std::uint64_t sent);

  private:
    enum class Form { Keyframe, Delta, Again };
    /// A tile that somebody was sent.
    struct Tile {
        std::uint16_t ticks = 0;                  // that its displacements took
        std::uint64_t base_sequence = 0;          // 0: it is a keyframe for all
        runtime::Clock::time_point keyframe_made; // the last that was one for all
        std::string delta;                        // its body, if base_sequence is not 0
        codec::Seams delta_seams;
        std::array<std::array<SharedBytes, 2>, 3> forms; // each as it is, and compressed
    };
    Tile& full(std::uint32_t tile);
    codec::BaselineView baseline(std::uint32_t tile) const;

    std::shared_ptr<IslandTiles> island_;
    std::shared_ptr<TiledSnapshot> before_; // nothing is told from it if it is null
    std::uint16_t ticks_ = 0;               // since then
    runtime::Clock::time_point now_;
    runtime::Clock::duration between_;
    std::vector<std::unique_ptr<Tile>> tiles_; // by index; null: nobody was sent it
    struct Displacements {
        std::vector<std::uint32_t> x, y; // tile after tile
    };
    Displacements organisms_, crates_;
};

using TiledSnapshotPtr = std::shared_ptr<TiledSnapshot>;

/// What of an island a viewer was sent last, which is what its next frame can be told from.
class SentTiles {
  public:
    /// Adds the parts of a frame to `parts`: together its fields 1 to 49. They are there as long as the picture is.
    void add_parts(TiledSnapshot& picture, const codec::TileRange& seen, v1::Detail detail, v1::Compression compression,
                   std::vector<const SharedBytes*>& parts) const;

    /// That frame has been sent.
    void sent(const TiledSnapshot& picture, const codec::TileRange& seen, v1::Detail detail);

    /// Keyframes are next.
    void forget() { *this = {}; }

  private:
    std::uint64_t sequence_ = 0;
    codec::TileRange full_; // the tiles that were at DETAIL_FULL
};

} // namespace evod::streaming
