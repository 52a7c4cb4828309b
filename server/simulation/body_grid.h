// BodyGrid: some circles in square cells, for searches near a place.
//
// Threads      any number of threads may search while nothing is built.
// Determinism  nearest() chooses by distance, then by id, never by the order in a cell.
#pragma once

#include "server/physics/bodies.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace evod::simulation {

class BodyGrid {
  public:
    static constexpr std::uint32_t none = ~0U;

    /// Sorts circles into the cells of their present positions.
    ///
    /// members  indices of circles that are not void.
    void build(const physics::Circles& circles, std::span<const std::uint32_t> members, const physics::Area& area);
    void clear() { sorted_.clear(); }

    bool empty() const { return sorted_.empty(); }
    std::span<const std::uint32_t> members() const { return sorted_; }

    /// Returns the index of the nearest member that is_wanted(index) accepts, among those at most `reach` px away from
    /// (x, y), centre to centre; equal distances: the lowest id. `none` if there is none. Members that have become void
    /// are left out. `circles` are those with which the grid was built, at the same places.
    template <class IsWanted>
    std::uint32_t nearest(const physics::Circles& circles, physics::Coordinate x, physics::Coordinate y, float reach,
                          const IsWanted& is_wanted) const {
        std::uint32_t best = none;
        float best_square = reach * reach;
        const double units = static_cast<double>(reach) * physics::units_per_px + 1;
        const std::uint32_t left = column_at(x - units), right = column_at(x + units), bottom = row_at(y + units);
        for (std::uint32_t row = row_at(y - units); !empty() && row <= bottom; ++row) {
            const std::uint32_t end = starts_[row * columns_ + right + 1];
            for (std::uint32_t place = starts_[row * columns_ + left]; place < end; ++place) {
                const std::uint32_t i = sorted_[place];
                const float dx = physics::distance_px(x, circles.x[i]), dy = physics::distance_px(y, circles.y[i]);
                const float square = dx * dx + dy * dy;
                const bool nearer = square < best_square ||
                                    (square == best_square && (best == none || circles.id[i] < circles.id[best]));
                if (nearer && !circles.is_void(i) && is_wanted(i)) {
                    best = i;
                    best_square = square;
                }
            }
        }
        return best;
    }

  private:
    std::uint32_t column_at(double x) const { return at(x, columns_); }
    std::uint32_t row_at(double y) const { return at(y, rows_); }
    std::uint32_t at(double position, std::uint32_t count) const {
        return static_cast<std::uint32_t>(std::clamp(position * cells_per_unit_, 0.0, count - 1.0));
    }

    double cells_per_unit_ = 1; // along each axis
    std::uint32_t columns_ = 1, rows_ = 1;
    std::vector<std::uint32_t> starts_; // per cell, row by row: where its members begin in sorted_; and the end
    std::vector<std::uint32_t> sorted_;
};

} // namespace evod::simulation
