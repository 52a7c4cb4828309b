// Reordering: applies one order to all columns of one kind of entity, leaving out void elements.
//
// Threads      blocks of a column are copied in parallel.
#pragma once

#include "server/base/assert.h"
#include "server/base/column.h"
#include "server/base/executor.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace evod::physics {

/// Kernels process several bodies at once, so the length of the columns that they read is a multiple of this number.
constexpr std::size_t lanes_max = 16;
constexpr std::size_t padded(std::size_t size) {
    return (size + lanes_max - 1) / lanes_max * lanes_max;
}

class Reordering {
  public:
    /// order  the indices of the elements to keep, in their new order; each at most once.
    /// spare  working memory, shared by all columns; owned by the caller.
    Reordering(std::span<const std::uint32_t> order, base::Column<std::uint32_t>& spare, base::Executor& executor)
        : order_{order}, spare_{spare}, executor_{executor} {}

    std::size_t size() const { return order_.size(); }

    /// Element i becomes the former element order[i]; `filling` fills the column up to padded(size()).
    template <class T>
    void apply(base::Column<T>& column, T filling) const {
        static_assert(sizeof(T) == sizeof(std::uint32_t));
        EVOD_ASSERT(order_.size() <= column.size());
        constexpr std::size_t grain = 2048;
        spare_.resize(order_.size());
        executor_.parallel_for(order_.size(), grain, [&](base::Range range) {
            for (std::size_t i = range.begin; i < range.end; ++i) {
                std::memcpy(&spare_[i], &column[order_[i]], sizeof(T));
            }
        });
        executor_.parallel_for(order_.size(), grain, [&](base::Range range) {
            std::memcpy(&column[range.begin], &spare_[range.begin], (range.end - range.begin) * sizeof(T));
        });
        column.resize(order_.size());
        column.resize(padded(order_.size()), filling);
    }

  private:
    std::span<const std::uint32_t> order_;
    base::Column<std::uint32_t>& spare_;
    base::Executor& executor_;
};

} // namespace evod::physics
