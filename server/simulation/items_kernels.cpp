// This file is a kernel: it is compiled once for each instruction set. base/lanes.h describes what it may include.
#include "server/simulation/items_kernels.h"

#include "server/base/lanes.h"
#include "server/physics/units.h"

namespace evod::simulation {
namespace {

using namespace evod::base; // the vector types of lanes.h
using physics::void_position;

constexpr float px = physics::px_per_unit, units = physics::units_per_px;

template <class T>
T least(T a, T b) {
    return b < a ? b : a;
}
template <class T>
T greatest(T a, T b) {
    return a < b ? b : a;
}

/// Returns to − from. For empty slots the subtraction may wrap around, but the result is still a large distance.
Floats distances(std::int32_t from, const std::int32_t* to) {
    return to_floats((Integers)(load<Words>(to) - static_cast<std::uint32_t>(from)));
}

float least_lane(Floats v) {
#if EVOD_LANES == 8
    v = lesser(v, __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3));
    v = lesser(v, __builtin_shufflevector(v, v, 2, 3, 0, 1, 6, 7, 4, 5));
    v = lesser(v, __builtin_shufflevector(v, v, 1, 0, 3, 2, 5, 4, 7, 6));
#else
    v = lesser(v, __builtin_shufflevector(v, v, 2, 3, 0, 1));
    v = lesser(v, __builtin_shufflevector(v, v, 1, 0, 3, 2));
#endif
    return v[0];
}

/// The two nearest places found so far. Each lane keeps the two nearest of its own slots, so that no branch depends on
/// the result.
///
/// Squared distances are in units² until the end. They equal px² times a power of two, so they have the same
/// significant bits.
class Search {
  public:
    Search(const ItemGrid& grid, std::int32_t x, std::int32_t y) : grid_{grid}, x_{x}, y_{y} {}

    void look_at_bucket(std::uint32_t b) {
        const ItemBucket& bucket = grid_.buckets[static_cast<std::int32_t>(b)];
        for (std::uint32_t first = 0; first < ItemBucket::slots; first += lanes) {
            const Floats dx = distances(x_, bucket.x + first), dy = distances(y_, bucket.y + first);
            const Floats square = dx * dx + dy * dy;
            place_ = square < best_ ? slot_of_lane + (b * ItemBucket::slots + first) : place_;
            second_ = lesser(second_, greater(best_, square));
            best_ = lesser(best_, square);
        }
    }

    /// Tests all buckets of a cell except its first bucket.
    void look_at_overflow(std::uint32_t cell) {
        // The positions are already loaded. Testing them avoids reading grid_.next for most buckets.
        for (std::uint32_t b = cell;
             grid_.buckets[static_cast<std::int32_t>(b)].x[ItemBucket::slots - 1] != void_position;) {
            b = grid_.next[b];
            if (b == no_item) {
                break;
            }
            look_at_bucket(b);
        }
    }

    void look_at_cells(std::int64_t top, std::int64_t bottom, std::int64_t left, std::int64_t right) {
        bottom = least<std::int64_t>(bottom, grid_.rows - 1);
        right = least<std::int64_t>(right, grid_.columns - 1);
        for (std::int64_t row = greatest<std::int64_t>(top, 0); row <= bottom; ++row) {
            for (std::int64_t column = greatest<std::int64_t>(left, 0); column <= right; ++column) {
                const std::uint32_t cell =
                    static_cast<std::uint32_t>(row) * grid_.columns + static_cast<std::uint32_t>(column);
                look_at_bucket(cell);
                look_at_overflow(cell);
            }
        }
    }

    /// Returns the squared distance of the second nearest item so far, units²; greater than any possible distance if
    /// there is no such item.
    float others_square() const {
        const float best = least_lane(best_);
        const Floats without_best = best_ == best ? all_lanes(__FLT_MAX__) : best_;
        const bool tie = (bits_of(best_ == best) & (bits_of(best_ == best) - 1)) != 0;
        return tie ? best : least_lane(lesser(second_, without_best));
    }

    TwoNearest result(float radius) const {
        const float within = radius * radius * (units * units);
        const float best = least_lane(best_);
        const float others = least(others_square(), within) * (px * px);
        if (best > within) {
            return {no_item, void_position, void_position, within * (px * px), within * (px * px)};
        }
        std::uint32_t place = place_[__builtin_ctz(bits_of(best_ == best))];
        if (others * (units * units) == best) {
            place = lowest_id_at(best, place);
        }
        const ItemBucket& bucket = grid_.buckets[place / ItemBucket::slots];
        return {place, bucket.x[place % ItemBucket::slots], bucket.y[place % ItemBucket::slots], best * (px * px),
                others};
    }

  private:
    /// Finds the item with the lowest id among several items at the same distance. This case is rare, so the function
    /// searches all cells within that distance, item by item.
    std::uint32_t lowest_id_at(float square, std::uint32_t place) const;

#if EVOD_LANES == 8
    static constexpr Words slot_of_lane{0, 1, 2, 3, 4, 5, 6, 7};
#else
    static constexpr Words slot_of_lane{0, 1, 2, 3};
#endif
    const ItemGrid& grid_;
    const std::int32_t x_, y_;
    Floats best_ = all_lanes(__FLT_MAX__), second_ = all_lanes(__FLT_MAX__);
    Words place_{};
};

std::int64_t cell_at(std::int64_t position, std::uint64_t scale, std::uint32_t count) {
    const auto inside =
        static_cast<std::uint64_t>(least<std::int64_t>(greatest<std::int64_t>(position, 0), 0x7fff'ffff));
    return least<std::int64_t>(static_cast<std::int64_t>(inside * scale >> ItemGrid::scale_bits), count - 1);
}

struct Cells {
    std::int64_t left, right, top, bottom; // all inclusive
};

Cells cells_within(const ItemGrid& grid, std::int32_t x, std::int32_t y, std::int64_t reach) {
    return {cell_at(x - reach, grid.scale, grid.columns), cell_at(x + reach, grid.scale, grid.columns),
            cell_at(y - reach, grid.scale, grid.rows), cell_at(y + reach, grid.scale, grid.rows)};
}

std::uint32_t Search::lowest_id_at(float square, std::uint32_t place) const {
    const auto reach = static_cast<std::int64_t>(__builtin_sqrtf(square) * (1 + 1e-5f)) + 2;
    const Cells cells = cells_within(grid_, x_, y_, reach);
    std::uint32_t lowest = grid_.items[place / ItemBucket::slots][place % ItemBucket::slots];
    for (std::int64_t row = cells.top; row <= cells.bottom; ++row) {
        for (std::int64_t column = cells.left; column <= cells.right; ++column) {
            for (std::uint32_t b = static_cast<std::uint32_t>(row) * grid_.columns + static_cast<std::uint32_t>(column);
                 b != no_item; b = grid_.next[b]) {
                for (std::uint32_t slot = 0; slot < ItemBucket::slots; ++slot) {
                    if (grid_.buckets[b].x[slot] == void_position) {
                        break;
                    }
                    const auto dx = static_cast<float>(grid_.buckets[b].x[slot] - x_);
                    const auto dy = static_cast<float>(grid_.buckets[b].y[slot] - y_);
                    if (dx * dx + dy * dy == square && grid_.items[b][slot] < lowest) {
                        lowest = grid_.items[b][slot];
                        place = b * ItemBucket::slots + slot;
                    }
                }
            }
        }
    }
    return place;
}

TwoNearest two_nearest_of(const ItemGrid& grid, const ItemQuery& query) {
    const auto [x, y, radius] = query;
    Search search{grid, x, y};
    const Cells cells = cells_within(grid, x, y, static_cast<std::int64_t>(radius * units) + 1);
    const std::int64_t more_columns = cells.right - cells.left, more_rows = cells.bottom - cells.top;
    if (more_columns <= 1 && more_rows <= 1) {
        // The usual case: exactly four buckets are tested, without a branch. An empty bucket replaces each one that is
        // not needed.
        const std::uint32_t empty = ~0u;
        const auto first =
            static_cast<std::uint32_t>(cells.top) * grid.columns + static_cast<std::uint32_t>(cells.left);
        const std::uint32_t right = more_columns != 0 ? first + 1 : empty;
        const std::uint32_t below = more_rows != 0 ? first + grid.columns : empty;
        const std::uint32_t across = more_columns != 0 && more_rows != 0 ? first + grid.columns + 1 : empty;
        const std::uint32_t around[4] = {first, right, below, across};
        for (const std::uint32_t cell : around) {
            search.look_at_bucket(cell);
        }
        for (const std::uint32_t cell : around) {
            search.look_at_overflow(cell);
        }
        return search.result(radius);
    }
    if (more_columns < 4 && more_rows < 4) {
        search.look_at_cells(cells.top, cells.bottom, cells.left, cells.right);
        return search.result(radius);
    }
    // Searches the first cell and the ring around it, which usually contain the two nearest items, and then further
    // rings, until the next ring is further away than the two nearest items.
    const std::int64_t column = cell_at(x, grid.scale, grid.columns), row = cell_at(y, grid.scale, grid.rows);
    // The distance from (x, y) to the nearest edge of its cell, slightly reduced, because cell edges are rounded.
    const std::int64_t from_left = x - column * grid.side, from_top = y - row * grid.side;
    const std::int64_t to_edge =
        least(least(from_left, grid.side - from_left), least(from_top, grid.side - from_top)) - (grid.side >> 12) - 1;
    const std::int64_t rings =
        greatest(greatest(column - cells.left, cells.right - column), greatest(row - cells.top, cells.bottom - row));
    search.look_at_cells(row - 1, row + 1, column - 1, column + 1);
    for (std::int64_t ring = 2; ring <= rings; ++ring) {
        const auto distance = static_cast<float>(greatest<std::int64_t>((ring - 1) * grid.side + to_edge, 0));
        if (distance * distance * (1 - 1e-5f) > search.others_square()) {
            break;
        }
        const auto look_at_row = [&](std::int64_t r, std::int64_t left, std::int64_t right) {
            if (r >= 0 && r < grid.rows) {
                search.look_at_cells(r, r, left, right);
            }
        };
        const auto look_at_column = [&](std::int64_t c) {
            if (c >= 0 && c < grid.columns) {
                search.look_at_cells(row - ring + 1, row + ring - 1, c, c);
            }
        };
        look_at_row(row - ring, column - ring, column + ring);
        look_at_row(row + ring, column - ring, column + ring);
        look_at_column(column - ring);
        look_at_column(column + ring);
    }
    return search.result(radius);
}

void prefetch(const ItemGrid& grid, const ItemQuery* queries, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        const Cells cells =
            cells_within(grid, queries[i].x, queries[i].y, static_cast<std::int64_t>(queries[i].radius * units) + 1);
        const std::int64_t first = cells.top * grid.columns + cells.left,
                           last = cells.bottom * grid.columns + cells.left;
        __builtin_prefetch(grid.buckets + first);
        __builtin_prefetch(grid.buckets + first + (cells.right - cells.left));
        __builtin_prefetch(grid.buckets + last);
        __builtin_prefetch(grid.buckets + last + (cells.right - cells.left));
    }
}

void two_nearest(const ItemGrid& grid, const ItemQuery* queries, TwoNearest* answers, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        answers[i] = two_nearest_of(grid, queries[i]);
    }
}

} // namespace

extern const ItemsKernels EVOD_KERNEL(items_kernels);
const ItemsKernels EVOD_KERNEL(items_kernels) = {prefetch, two_nearest};

} // namespace evod::simulation
