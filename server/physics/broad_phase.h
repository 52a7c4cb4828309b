// Broad phase: sorts circles into strips and lists the pairs of bodies that may touch soon.
//
// A strip is a horizontal band of the area. It is at least as high as the greatest reach of two bodies, and its circles
// are sorted by x. All circles that a circle may touch are therefore its neighbours in its own strip, or in one
// contiguous range of an adjacent strip. No array is as large as the area, so the cost depends only on the number of
// circles. It does not depend on crowds, empty regions or the shape of the island.
//
// A pair is listed if the gap between its two bodies is at most the skin, a chosen distance (the list of Verlet 1967,
// "Computer experiments on classical fluids"). The two bodies of an unlisted pair can touch only after one of them has
// moved more than half the skin. The list is renewed before that, so only listed pairs are tested.
//
// Threads      strips and blocks of circles are processed in parallel.
// Determinism  the list contains every touching pair, however thick the skin is. contacts.h then resolves touching
//              pairs in a fixed order.
#pragma once

#include "server/base/assert.h"
#include "server/base/executor.h"
#include "server/physics/bodies.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace evod::physics {

/// The number of circles that one piece of a parallel loop processes. Their columns are small enough to stay in the
/// first-level cache while several kernels process them.
constexpr std::size_t circles_per_block = 512;
constexpr std::size_t block_count(std::size_t circles) {
    return (circles + circles_per_block - 1) / circles_per_block;
}
/// Returns whether a loop over this many circles is long enough to be divided among several threads.
constexpr bool worth_dividing(std::size_t circles) {
    return circles >= 4096;
}
/// Returns how many blocks one piece of a parallel loop processes: all blocks if the loop is not worth dividing.
constexpr std::size_t blocks_per_piece(std::size_t circles) {
    return worth_dividing(circles) ? 1 : block_count(circles) + 1;
}
constexpr base::Range circles_of_block(std::size_t circles, std::size_t block) {
    return {block * circles_per_block, std::min((block + 1) * circles_per_block, circles)};
}

/// Changes the number of lists to one per block. Existing lists keep their memory; a new list reserves memory for
/// `usually_enough` elements.
template <class T>
void resize_lists(std::vector<std::vector<T>>& list_of_block, std::size_t blocks, std::size_t usually_enough) {
    const std::size_t before = list_of_block.size();
    list_of_block.resize(blocks);
    for (std::size_t block = before; block < blocks; ++block) {
        list_of_block[block].reserve(usually_enough);
    }
}

/// The circles that are not void, sorted by strip, and within a strip by (x, id).
class Strips {
  public:
    /// Sorts the circles. `reach_px` is the greatest distance at which neighbours will be requested, and the minimum
    /// height of a strip.
    void sort(const Circles& circles, const Area& area, float reach_px, base::Executor& executor);

    /// The indices of the circles, in sorted order.
    std::span<const std::uint32_t> order() const { return order_; }
    /// Resets order() to 0, 1, 2, …. Must be called after the circles have been reordered by order().
    void follow_reordering();

    std::uint32_t strip_count() const { return strips_; }
    double strip_height_px() const {
        return static_cast<double>(std::uint64_t{1} << scale_bits) / static_cast<double>(strip_scale_) / units_per_px;
    }
    /// Returns the range of order() that contains the circles of a strip.
    base::Range strip(std::uint32_t strip) const {
        const std::size_t cell = std::size_t{strip} * columns_;
        return {first_[cell], first_[cell + columns_]};
    }
    /// Returns the strip that contains place k of order().
    std::uint32_t strip_of_place(std::size_t k) const;
    std::uint32_t strip_at(std::int64_t y) const { return index_at(y, strip_scale_, strips_); }
    /// A range of neighbouring cells in one strip, as indices into first_.
    struct Stretch {
        std::uint32_t first_cell, end_cell;
    };
    /// Calls visit(stretch) for one stretch per strip. Together the stretches contain every circle with left <= x <=
    /// right and top <= y <= bottom, in units, and a few other circles.
    template <class Visit>
    void for_each_stretch(std::int64_t left, std::int64_t right, std::int64_t top, std::int64_t bottom,
                          Visit&& visit) const {
        const std::uint32_t first_column = index_at(left, column_scale_, columns_);
        const std::uint32_t end_column = index_at(right, column_scale_, columns_) + 1;
        const std::uint32_t last = strip_at(bottom) * columns_;
        for (std::uint32_t row = strip_at(top) * columns_; row <= last; row += columns_) {
            visit(Stretch{row + first_column, row + end_column});
        }
    }
    /// Returns the range of order() that contains the circles of a stretch.
    base::Range places(Stretch stretch) const { return {first_[stretch.first_cell], first_[stretch.end_cell]}; }
    /// Prefetches the memory that places() reads.
    void prefetch(Stretch stretch) const { __builtin_prefetch(&first_[stretch.first_cell]); }
    /// Returns a place in order() at or shortly before the first circle of the strip whose x is at least `left`.
    std::size_t place_of(std::uint32_t strip, std::int64_t left) const {
        return first_[std::size_t{strip} * columns_ + index_at(left, column_scale_, columns_)];
    }

  private:
    // Each strip is divided into cells: on average one per circle. Sorting first counts the circles of each cell.
    static std::uint32_t index_at(std::int64_t position, std::uint64_t scale, std::uint32_t count) {
        const auto clamped = static_cast<std::uint64_t>(std::clamp<std::int64_t>(position, 0, 0x7fff'ffff));
        return static_cast<std::uint32_t>(std::min<std::uint64_t>(clamped * scale >> scale_bits, count - 1));
    }
    void choose_cells(std::size_t circles, const Area& area, float reach_px);
    template <bool parallel>
    void count_and_place(const Circles& circles, base::Executor& executor);
    std::size_t cell_of(const Circles& circles, std::size_t i) const {
        return std::size_t{strip_at(circles.y[i])} * columns_ + index_at(circles.x[i], column_scale_, columns_);
    }

    static constexpr unsigned scale_bits = 32;
    std::uint32_t strips_ = 0, columns_ = 0;
    std::uint64_t strip_scale_ = 0, column_scale_ = 0; // strips and columns per unit, times 2^scale_bits
    base::Column<std::uint32_t> first_; // per cell: where its circles begin in order_; one more element at the end
    base::Column<std::uint32_t> order_;
};

/// The list of pairs of bodies whose gap is at most the skin.
class NearPairs {
  public:
    struct Pair {
        std::uint32_t a, b; // indices of the two bodies
    };

    /// Returns whether pairs that are not listed might touch, so that the list must be renewed; true before the first
    /// list.
    bool stale(const Circles& circles, const Boxes& boxes) const;
    /// Makes stale() return true; for use after all bodies have been replaced.
    void invalidate() {
        displacement_square_ = std::numeric_limits<float>::infinity();
        skin_share_ = 1;
    }
    /// Ignores the displacement of a circle from now on. Must be called when the circle becomes void.
    void remove(std::size_t circle) {
        EVOD_ASSERT(circle < circle_count_);
        anchor_x_[circle] = anchor_y_[circle] = void_position;
    }
    /// Sets the displacement that stale() uses: the squared distance of the circle furthest from its anchor, px². The
    /// anchor of a circle is its position at the last sort().
    void set_displacement_square(float displacement_square) {
        EVOD_ASSERT(displacement_square >= 0);
        displacement_square_ = displacement_square;
    }

    /// Renews the list from the present positions: sort(), then list(). To reorder circles, call sort(), then reorder
    /// them, then call list().
    void renew(const Circles& circles, const Boxes& boxes, const Area& area, base::Executor& executor) {
        sort(circles, boxes, area, executor);
        list(circles, boxes, executor);
    }
    /// Stores the present positions of the circles as their anchors, and sorts the circles.
    void sort(const Circles& circles, const Boxes& boxes, const Area& area, base::Executor& executor);
    const Strips& strips() const { return strips_; }
    /// Applies a new order of the circles to the stored data. Must be called after the circles have been reordered by
    /// strips().order().
    void follow_reordering(const Circles& circles, base::Executor& executor);
    /// Lists the pairs; uses the result of the last sort().
    void list(const Circles& circles, const Boxes& boxes, base::Executor& executor);

    /// Lists no pairs, instead of list(), where bodies have no contacts.
    void list_none(const Circles& circles);

    /// Returns the pairs of circles that were found in a block of circles.
    std::span<const Pair> circle_pairs(std::size_t block) const {
        EVOD_ASSERT(block < pairs_of_block_.size());
        return pairs_of_block_[block];
    }
    /// Pairs of a circle (Pair::a) and a box (Pair::b).
    std::span<const Pair> circle_box_pairs() const { return circle_box_pairs_; }
    /// Pairs of boxes, at least one of which can move.
    std::span<const Pair> box_pairs() const { return box_pairs_; }

    const base::Column<Coordinate>& anchor_x() const { return anchor_x_; } // per circle
    const base::Column<Coordinate>& anchor_y() const { return anchor_y_; }
    float skin_px() const { return skin_px_; }

    /// Calls visit(stretch) for several stretches. Together they contain every circle that is now at most `radius` px
    /// from (x, y), and some other circles.
    template <class Visit>
    void for_each_stretch_near(Coordinate x, Coordinate y, float radius, Visit&& visit) const {
        const auto reach = static_cast<std::int64_t>((radius + std::sqrt(displacement_square_) + 0.1f) * units_per_px);
        strips_.for_each_stretch(x - reach, x + reach, y - reach, y + reach, visit);
    }

  private:
    void anchor(const Circles& circles, base::Executor& executor);
    /// Returns false if the circles are too crowded for the present skin.
    bool try_list_circle_pairs(const Circles& circles, base::Executor& executor);
    void list_box_pairs(const Circles& circles, const Boxes& boxes);

    Strips strips_;
    base::Column<Coordinate> anchor_x_, anchor_y_;
    base::Column<Coordinate> box_anchor_x_, box_anchor_y_;
    std::size_t circle_count_ = 0;
    float displacement_square_ = std::numeric_limits<float>::infinity();
    float radius_max_ = 0; // px
    float skin_px_ = 0;
    float skin_share_ = 1; // factor on the skin that suits evenly distributed circles; below 1 in crowds
    std::vector<std::vector<Pair>> pairs_of_block_;
    std::vector<Pair> circle_box_pairs_, box_pairs_;
    std::vector<std::uint32_t> boxes_by_left_;
};

} // namespace evod::physics
