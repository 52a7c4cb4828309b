// Tiles: an island cut into squares, for viewers of a region or of less detail. The layout of a tile's body is described in
// stream.proto.
//
// A tile at DETAIL_FULL is a QuantisedSnapshot, which the delta codec encodes like a whole island. Dots and densities have
// no baseline. All tiles together are the island: each entity is in the tile that contains its centre.
//
// Determinism  integers only, as for all snapshots.
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

/// The tiles of an island, numbered row after row.
struct TileLayout {
    double width_px = 0, height_px = 0;  // of the island
    std::uint32_t tile_px = tile_px_min; // side, a power of two
    std::uint32_t columns = 1, rows = 1;

    std::uint32_t count() const { return columns * rows; }
    friend bool operator==(const TileLayout&, const TileLayout&) = default;
};

/// The layout with the smallest tiles that gives at most tiles_max of them.
TileLayout tile_layout(double width_px, double height_px);

/// The layout in a frame. The caller has checked the size of the island.
Result<TileLayout> tile_layout_of(const evod::v1::SnapshotFrame& frame);

/// The tiles of a rectangle; the ends are exclusive.
struct TileRange {
    std::uint32_t column_begin = 0, column_end = 0, row_begin = 0, row_end = 0;

    bool contains(const TileLayout& layout, std::uint32_t tile) const {
        const std::uint32_t column = tile % layout.columns, row = tile / layout.columns;
        return column >= column_begin && column < column_end && row >= row_begin && row < row_end;
    }
    /// Calls what(tile) for each tile, indices rising.
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

/// The tiles that a region touches. The region is finite and its size positive.
TileRange tiles_of(const evod::v1::Region& region, const TileLayout& layout);
/// All tiles.
TileRange tiles_of(const TileLayout& layout);

/// A snapshot sorted into tiles. The constructor sorts the indices; the columns of a tile are gathered on its first use.
/// Used by one thread.
class SnapshotTiles {
  public:
    SnapshotTiles(std::shared_ptr<const QuantisedSnapshot> snapshot, const TileLayout& layout);

    const TileLayout& layout() const { return layout_; }

    Counts counts(std::uint32_t tile) const;
    /// Counts of all tiles before `tile`, which may be layout().count().
    Counts counts_before(std::uint32_t tile) const;
    /// The entities of a tile; boxes have ids. Valid as long as this object.
    QuantisedView full(std::uint32_t tile);
    /// The body of a tile of DETAIL_DOTS.
    std::string dots(std::uint32_t tile) const;
    /// The body of a tile of DETAIL_DENSITY.
    std::string density(std::uint32_t tile) const;

  private:
    struct Part {
        std::vector<std::uint32_t> order; // indices of entities, tile after tile, rising within each
        std::vector<std::uint32_t> begin; // offset of each tile in `order`, and the end of the last
        // The snapshot's columns in that order, filled for the gathered tiles; null before, and if the kind has no such column.
        std::array<std::unique_ptr<std::uint32_t[]>, 5> columns;
    };
    std::span<const std::uint32_t> of(std::size_t part, std::uint32_t tile) const;
    /// The position of an entity within a tile, in 1/256 of its side.
    struct Place {
        std::uint8_t x, y;
    };
    Place place(const Entities& entities, std::uint32_t entity, std::uint32_t tile) const;

    std::shared_ptr<const QuantisedSnapshot> snapshot_;
    TileLayout layout_;
    unsigned side_log2_;               // of a tile, in steps
    unsigned cells_per_side_log2_ = 0; // of a density grid
    std::array<Part, snapshot_parts.size()> parts_;
    std::vector<bool> gathered_; // by tile
};

/// Merges tiles. Damage if an entity is in two of them.
Result<QuantisedSnapshot> merged(std::uint32_t position_bytes, std::span<const QuantisedSnapshot* const> tiles);

Result<DecodedDots> decode_dots(std::string_view body, const Counts& counts, const TileLayout& layout,
                                std::uint32_t tile);
Result<DecodedDensity> decode_density(std::string_view body, const Counts& counts);

/// Size of the longest body of a tile of DETAIL_DENSITY.
constexpr std::uint64_t density_bytes_max = 16 << 10;

/// SnapshotTile.checksum.
///
/// tile_px, position_bytes  of the frame.
/// body                     before compression.
std::uint32_t checksum_of(std::uint32_t tile_px, std::uint32_t position_bytes, const evod::v1::SnapshotTile& tile,
                          std::string_view body);

} // namespace evod::codec
