// Tiles: the squares into which an island is divided, for viewers that show only a region or less detail. stream.proto
// describes the body of a tile.
//
// A tile at DETAIL_FULL is a QuantisedSnapshot, which the delta codec encodes in the same way as a whole island. Dots
// and densities have no baseline. Each entity is in exactly one tile: the one that contains its centre.
//
// Determinism  all arithmetic uses integers, as for all snapshots.
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

constexpr std::uint32_t tiles_max = 1024;  // maximum number of tiles of an island
constexpr std::uint32_t tile_px_min = 512; // minimum side of a tile

/// Describes the tiles of an island. They are numbered row after row.
struct TileLayout {
    double width_px = 0, height_px = 0;  // size of the island
    std::uint32_t tile_px = tile_px_min; // side of a tile; a power of two
    std::uint32_t columns = 1, rows = 1;

    std::uint32_t count() const { return columns * rows; }
    friend bool operator==(const TileLayout&, const TileLayout&) = default;
};

/// Returns the layout with the smallest tiles that has at most tiles_max tiles.
TileLayout tile_layout(double width_px, double height_px);

/// Returns the layout that a frame states. The caller must have checked the size of the island.
Result<TileLayout> tile_layout_of(const evod::v1::SnapshotFrame& frame);

/// A rectangle of tiles. The ends are exclusive.
struct TileRange {
    std::uint32_t column_begin = 0, column_end = 0, row_begin = 0, row_end = 0;

    bool contains(const TileLayout& layout, std::uint32_t tile) const {
        const std::uint32_t column = tile % layout.columns, row = tile / layout.columns;
        return column >= column_begin && column < column_end && row >= row_begin && row < row_end;
    }
    /// Calls what(tile) for each tile, in order of the indices.
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

/// Returns the tiles that a region touches. The region must be finite and its size positive.
TileRange tiles_of(const evod::v1::Region& region, const TileLayout& layout);
/// Returns all tiles.
TileRange tiles_of(const TileLayout& layout);

/// Sorts the entities of a snapshot into tiles. The constructor sorts only their indices. The columns of a tile are
/// copied when the tile is used for the first time. Only one thread may use it.
class SnapshotTiles {
  public:
    SnapshotTiles(std::shared_ptr<const QuantisedSnapshot> snapshot, const TileLayout& layout);

    const TileLayout& layout() const { return layout_; }

    Counts counts(std::uint32_t tile) const;
    /// Returns the sums of the counts of all tiles with an index below `tile`; `tile` may equal layout().count().
    Counts counts_before(std::uint32_t tile) const;
    /// Returns the entities of a tile, in which boxes have ids. The view is valid as long as this SnapshotTiles exists.
    QuantisedView full(std::uint32_t tile);
    /// Encodes the body of a tile at DETAIL_DOTS.
    std::string dots(std::uint32_t tile) const;
    /// Encodes the body of a tile at DETAIL_DENSITY.
    std::string density(std::uint32_t tile) const;
    /// The memory that this object has allocated, without the snapshot.
    std::size_t held_bytes() const;

  private:
    struct Part {
        std::vector<std::uint32_t> order; // indices of entities, grouped by tile, in rising order within each tile
        std::vector<std::uint32_t> begin; // for each tile its first position in `order`, then the end of the last tile
        // The columns of the snapshot in the order of `order`. Only the parts of gathered tiles are filled. A column is
        // nullptr if it is not allocated yet, or if the kind does not have it.
        std::array<std::unique_ptr<std::uint32_t[]>, 7> columns;
    };
    std::span<const std::uint32_t> of(std::size_t part, std::uint32_t tile) const;
    /// A position within a tile, in 1/256 of the tile's side.
    struct Place {
        std::uint8_t x, y;
    };
    Place place(const Entities& entities, std::uint32_t entity, std::uint32_t tile) const;

    std::shared_ptr<const QuantisedSnapshot> snapshot_;
    TileLayout layout_;
    unsigned side_log2_;               // log2 of the side of a tile in steps
    unsigned cells_per_side_log2_ = 0; // log2 of the number of cells per side of a density
    std::array<Part, snapshot_parts.size()> parts_;
    std::vector<bool> gathered_; // index: tile
};

/// Merges tiles into one snapshot. Returns Damage if two tiles contain the same entity.
Result<QuantisedSnapshot> merged(std::uint32_t position_bytes, std::span<const QuantisedSnapshot* const> tiles);

Result<DecodedDots> decode_dots(std::string_view body, const Counts& counts, const TileLayout& layout,
                                std::uint32_t tile);
Result<DecodedDensity> decode_density(std::string_view body, const Counts& counts);

/// Maximum size of the body of a tile at DETAIL_DENSITY.
constexpr std::uint64_t density_bytes_max = 16 << 10;

/// Computes SnapshotTile.checksum.
///
/// tile_px, position_bytes  the fields of the frame.
/// body                     the body before compression.
std::uint32_t checksum_of(std::uint32_t tile_px, std::uint32_t position_bytes, const evod::v1::SnapshotTile& tile,
                          std::string_view body);

} // namespace evod::codec
