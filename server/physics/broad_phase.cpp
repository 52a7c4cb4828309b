#include "server/physics/broad_phase.h"

#include <algorithm>

namespace evod::physics {

void CircleGrid::build(const Circles& circles, const Area& area, float reach_px) {
    const std::size_t n = circles.size();
    const double share =
        static_cast<double>(area.width) * area.height / static_cast<double>(std::max<std::size_t>(n, 1));
    const double least = static_cast<double>(reach_px) * units_per_px;
    shift_ = 12;
    while (shift_ < 30 && (static_cast<double>(1u << shift_) < least ||
                           static_cast<double>(1u << shift_) * static_cast<double>(1u << shift_) < share))
        ++shift_;
    columns_ = (static_cast<std::uint32_t>(area.width) >> shift_) + 1;
    rows_ = (static_cast<std::uint32_t>(area.height) >> shift_) + 1;

    first_.assign(std::size_t{rows_} * columns_ + 1, 0);
    cell_of_.resize(n);
    order_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        cell_of_[i] = row_of(circles.y[i]) * columns_ + column_of(circles.x[i]);
        ++first_[cell_of_[i]];
    }
    std::uint32_t end = 0;
    for (std::uint32_t& first : first_)
        first = end += first;
    for (std::size_t i = n; i-- > 0;) // backwards, so that each cell's circles end up rising
        order_[--first_[cell_of_[i]]] = static_cast<std::uint32_t>(i);
    sorted_.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
        const std::uint32_t i = order_[k];
        sorted_[k] = {i, circles.x[i], circles.y[i], circles.radius[i]};
    }
}

std::span<const std::uint32_t> CircleGrid::cell(std::uint32_t row, std::uint32_t column) const {
    const std::size_t index = std::size_t{row} * columns_ + column;
    return {order_.data() + first_[index], first_[index + 1] - first_[index]};
}

std::uint32_t CircleGrid::column_of(std::int64_t x) const {
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(x >> shift_, 0, columns_ - 1));
}

std::uint32_t CircleGrid::row_of(std::int64_t y) const {
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(y >> shift_, 0, rows_ - 1));
}

} // namespace evod::physics
