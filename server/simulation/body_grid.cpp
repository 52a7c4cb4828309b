#include "server/simulation/body_grid.h"

namespace evod::simulation {

void BodyGrid::build(const physics::Circles& circles, std::span<const std::uint32_t> members,
                     const physics::Area& area) {
    constexpr double members_per_cell = 2, side_min_px = 16;
    const double per_cell = static_cast<double>(area.width) * area.height /
                            std::max(static_cast<double>(members.size()) / members_per_cell, 1.0);
    cells_per_unit_ = 1 / std::max(std::sqrt(per_cell), side_min_px * physics::units_per_px);
    columns_ = static_cast<std::uint32_t>(area.width * cells_per_unit_) + 1;
    rows_ = static_cast<std::uint32_t>(area.height * cells_per_unit_) + 1;
    starts_.assign(std::size_t{columns_} * rows_ + 1, 0);
    const auto cell_of = [&](std::uint32_t i) { return row_at(circles.y[i]) * columns_ + column_at(circles.x[i]); };
    for (const std::uint32_t i : members) {
        ++starts_[cell_of(i) + 1];
    }
    for (std::size_t cell = 1; cell < starts_.size(); ++cell) {
        starts_[cell] += starts_[cell - 1];
    }
    sorted_.resize(members.size());
    // Filling a cell moves its start to its end, which is the start of the next cell.
    for (const std::uint32_t i : members) {
        sorted_[starts_[cell_of(i)]++] = i;
    }
    std::rotate(starts_.begin(), starts_.end() - 1, starts_.end());
    starts_.front() = 0;
}

} // namespace evod::simulation
