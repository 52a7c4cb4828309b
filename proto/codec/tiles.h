// Tiles: an island cut into squares, for those who see a region of it, or less than everything. The layout of a tile's
// body is told in stream.proto.
//
// A tile at DETAIL_FULL is a QuantisedSnapshot of its own, told as the delta codec tells a whole island; dots and densities are
// told from nothing before them. All tiles together are the island: an entity is in the one that its centre is in.
//
// Determinism  whole numbers alone, as everywhere in pictures.
#pragma once

#include "evod/v1/commands.pb.h"
#include "evod/v1/stream.pb.h"
#include "proto/codec/delta_codec.h"
#include "proto/codec/result.h"
#include "proto/codec/snapshot_codec.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::codec {

constexpr std::uint32_t tiles_max = 1024;  // of an island
constexpr std::uint32_t tile_px_min = 512; // side

/// How an island is cut. Tiles are numbered row after row.
struct TileLayout {
    double width_px = 0, height_px = 0;  // of the island
    std::uint32_t tile_px = tile_px_min; // side, a power of two
    std::uint32_t columns = 1, rows = 1;

    std::uint32_t count() const { return columns * rows; }
    friend bool operator==(const TileLayout&, const TileLayout&) = default;
};

/// The smallest tiles of which there are at most tiles_max.
TileLayout tile_layout(double width_px, double height_px);

/// As a frame tells it, which may be anything; but its size has been judged.
Result<TileLayout> tile_layout_of(const evod::v1::SnapshotFrame& frame);

/// Some columns of some rows; from … up to, but without, ….
struct TileRange {
    std::uint32_t column_begin = 0, column_end = 0, row_begin = 0, row_end = 0;

    bool contains(const TileLayout& layout, std::uint32_t tile) const {
        const std::uint32_t column = tile % layout.columns, row = tile / layout.columns;
        return column >= column_begin && column < column_end && row >= row_begin && row < row_end;
    }
    /// Calls what(tile) of each, indices rising.
    template <class Do>
    void each(const TileLayout& layout, const Do& what) const {
        for (std::uint32_t row = row_begin; row < row_end; ++row) {
            for (std::uint32_t column = column_begin; column < column_end; ++column) {
                what(row * layout.columns + column);
            }
        }
    }
    friend bool operator==(const TileRange&, const TileRange&) = default;
};

/// The tiles that a region touches; one of any finite place, of positive size.
TileRange tiles_of(const evod::v1::Region& region, const TileLayout& layout);
/// All of them.
TileRange tiles_of(const TileLayout& layout);

/// A snapshot, and what of it is in which tile. To make one is to number the entities; those of a tile are put together
/// when it is first asked for. Used by one thread.
class SnapshotTiles {
  public:
    SnapshotTiles(std::shared_ptr<const QuantisedSnapshot> snapshot, const TileLayout& layout);

    const TileLayout& layout() const { return layout_; }

    Counts counts(std::uint32_t tile) const;
    /// How many there are in the tiles before it; tile may be layout().count().
    Counts counts_before(std::uint32_t tile) const;
    /// Its entities, boxes with ids; lies in this object.
    QuantisedView full(std::uint32_t tile);
    /// The body of a tile of DETAIL_DOTS.
    std::string dots(std::uint32_t tile) const;
    /// The body of a tile of DETAIL_DENSITY.
    std::string density(std::uint32_t tile) const;

  private:
    struct Part {
        std::vector<std::uint32_t> order; // indices of the snapshot's entities, tile after tile, rising within each
        std::vector<std::uint32_t> begin; // of each tile in `order`; and the end of the last
        // The snapshot's columns in that order, of the tiles that are put together; null where it has none, and before.
        std::array<std::unique_ptr<std::uint32_t[]>, 5> columns;
    };
    std::span<const std::uint32_t> of(std::size_t part, std::uint32_t tile) const;
    /// Where an entity is within a tile, in 1/256 of its side.
    struct Place {
        std::uint8_t x, y;
    };
    Place place(const Entities& entities, std::uint32_t entity, std::uint32_t tile) const;

    std::shared_ptr<const QuantisedSnapshot> snapshot_;
    TileLayout layout_;
    unsigned side_log2_;               // of a tile, in steps
    unsigned cells_per_side_log2_ = 0; // of densities
    std::array<Part, snapshot_parts.size()> parts_;
    std::vector<bool> together_; // by tile
};

/// All entities of some tiles, none of which may be in two of them.
Result<QuantisedSnapshot> merged(std::uint32_t position_bytes, std::span<const QuantisedSnapshot* const> tiles);

/// What bodies tell, which may be anything.
Result<DecodedDots> decode_dots(std::string_view body, const Counts& counts, const TileLayout& layout,
                                std::uint32_t tile);
Result<DecodedDensity> decode_density(std::string_view body, const Counts& counts);

/// The longest body that a tile of DETAIL_DENSITY can have.
constexpr std::uint64_t density_bytes_max = 16 << 10;

/// SnapshotTile.checksum.
///
/// tile_px, position_bytes  of the frame.
/// body                     before compression.
std::uint32_t checksum_of(std::uint32_t tile_px, std::uint32_t position_bytes, const evod::v1::SnapshotTile& tile,
                          std::string_view body);

} // namespace evod::codec
