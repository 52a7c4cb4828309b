// Broad phase: which circles and boxes are near enough to touch, by a uniform grid of the circles' centres.
//
// Threads      rows of cells are searched side by side.
// Determinism  the candidates are a set; contacts.h puts what touches in an order of its own.
#pragma once

#include "server/base/executor.h"
#include "server/physics/bodies.h"

#include <cstdint>
#include <span>
#include <vector>

namespace evod::physics {

/// Circles sorted into square cells whose side is a power of two of units; rebuilt each tick.
class CircleGrid {
  public:
    /// The side of a cell is at least `reach_px` and about one circle's share of the area.
    void build(const Circles& circles, const Area& area, float reach_px);

    std::uint32_t rows() const { return rows_; }
    std::uint32_t columns() const { return columns_; }
    /// Indices of the circles in a cell, rising.
    std::span<const std::uint32_t> cell(std::uint32_t row, std::uint32_t column) const;
    /// The circles cell by cell, each row of cells from left to right: index, place and radius.
    struct Sorted {
        std::uint32_t index;
        Coordinate x, y;
        float radius; // px
    };
    const std::vector<Sorted>& sorted() const { return sorted_; }
    /// Where in sorted() the circles of the cells `first` to `last` of a row stand; both included.
    base::Range in_row(std::uint32_t row, std::uint32_t first, std::uint32_t last) const {
        const std::size_t cells = std::size_t{row} * columns_;
        return {first_[cells + first], first_[cells + last + 1]};
    }
    std::uint32_t column_of(std::int64_t x) const; // clamped into the grid
    std::uint32_t row_of(std::int64_t y) const;

  private:
    unsigned shift_ = 0;
    std::uint32_t rows_ = 0, columns_ = 0;
    std::vector<std::uint32_t> first_;   // per cell: where its circles begin in order_; one more at the end
    std::vector<std::uint32_t> order_;   // circle indices, cell by cell
    std::vector<std::uint32_t> cell_of_; // per circle
    std::vector<Sorted> sorted_;
};

} // namespace evod::physics
