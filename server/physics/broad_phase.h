// Broad phase: circles sorted into strips, and the pairs of bodies that may touch before long.
//
// A strip is a row of the area as high as anything reaches; in it the circles stand in order of x. Whom a circle may
// touch stands next to it in its own strip and in a stretch of the next one. Nothing is as large as the area, so
// crowds, empty land and islands of any shape cost what the circles cost.
//
// The pairs are found with a skin around every body (Verlet 1967, "Computer experiments on classical fluids"): a pair
// that is not listed cannot touch until one of the two has moved half the skin. Between, only listed pairs are looked
// at.
//
// Threads      strips and blocks of circles are gone through side by side.
// Determinism  listed pairs are a superset of the touching ones, whatever the skin; contacts.h puts what touches in an
//              order of its own.
#pragma once

#include "server/base/executor.h"
#include "server/physics/bodies.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace evod::physics {

/// How many circles one piece of a parallel loop takes: few enough that their columns stay in the nearest cache while
/// one kernel after the other goes over them.
constexpr std::size_t circles_per_block = 512;
constexpr std::size_t block_count(std::size_t circles) {
    return (circles + circles_per_block - 1) / circles_per_block;
}
/// Whether a loop over so many circles is worth handing pieces of it over to other threads.
constexpr bool worth_cutting(std::size_t circles) {
    return circles >= 4096;
}
/// How many blocks one piece of a parallel loop takes: all, where it is not worth cutting.
constexpr std::size_t blocks_per_piece(std::size_t circles) {
    return worth_cutting(circles) ? 1 : block_count(circles) + 1;
}
constexpr base::Range circles_of_block(std::size_t circles, std::size_t block) {
    return {block * circles_per_block, std::min((block + 1) * circles_per_block, circles)};
}

/// As many lists as there are blocks, kept warm between ticks: a new one has room for what a block usually needs.
template <class T>
void resize_lists(std::vector<std::vector<T>>& list_of_block, std::size_t blocks, std::size_t usually_enough) {
    const std::size_t before = list_of_block.size();
    list_of_block.resize(blocks);
    for (std::size_t block = before; block < blocks; ++block) {
        list_of_block[block].reserve(usually_enough);
    }
}

/// The circles that are not void, strip by strip, each strip in order of (x, id).
class Strips {
  public:
    /// reach_px  greatest distance at which neighbours are asked for; a strip is at least as high.
    void sort(const Circles& circles, const Area& area, float reach_px, base::Executor& executor);

    /// Indices of the circles.
    std::span<const std::uint32_t> order() const { return order_; }
    /// To be called when circles have been reordered by order(): it counts from 0 up from now on.
    void follow_reordering();

    std::uint32_t strip_count() const { return strips_; }
    double strip_height_px() const {
        return static_cast<double>(std::uint64_t{1} << scale_bits) / static_cast<double>(strip_scale_) / units_per_px;
    }
    /// Where in order() the circles of a strip stand.
    base::Range strip(std::uint32_t strip) const {
        const std::size_t cell = std::size_t{strip} * columns_;
        return {first_[cell], first_[cell + columns_]};
    }
    /// The strip in which place k of order() is.
    std::uint32_t strip_of_place(std::size_t k) const;
    std::uint32_t strip_at(std::int64_t y) const { return index_at(y, strip_scale_, strips_); }
    /// Neighbouring cells of one strip, of which first_ tells the places.
    struct Stretch {
        std::uint32_t first_cell, end_cell;
    };
    /// Calls visit(stretch) for stretches, one a strip, that together hold every circle with left <= x <= right and top
    /// <= y <= bottom, units, and a few more.
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
    /// Where in order() the circles of a stretch stand.
    base::Range places(Stretch stretch) const { return {first_[stretch.first_cell], first_[stretch.end_cell]}; }
    /// Asks for the memory that places() needs.
    void prefetch(Stretch stretch) const { __builtin_prefetch(&first_[stretch.first_cell]); }
    /// Where in order() the circles of a strip from x = left on begin, or a little before.
    std::size_t place_of(std::uint32_t strip, std::int64_t left) const {
        return first_[std::size_t{strip} * columns_ + index_at(left, column_scale_, columns_)];
    }

  private:
    // Cells of a strip as wide as one circle's share of it: sorting starts with counting circles per cell.
    static std::uint32_t index_at(std::int64_t position, std::uint64_t scale, std::uint32_t count) {
        const auto clamped = static_cast<std::uint64_t>(std::clamp<std::int64_t>(position, 0, 0x7fff'ffff));
        return static_cast<std::uint32_t>(std::min<std::uint64_t>(clamped * scale >> scale_bits, count - 1));
    }
    void choose_cells(std::size_t circles, const Area& area, float reach_px);
    template <bool side_by_side>
    void count_and_place(const Circles& circles, base::Executor& executor);
    std::size_t cell_of(const Circles& circles, std::size_t i) const {
        return std::size_t{strip_at(circles.y[i])} * columns_ + index_at(circles.x[i], column_scale_, columns_);
    }

    static constexpr unsigned scale_bits = 32;
    std::uint32_t strips_ = 0, columns_ = 0;
    std::uint64_t strip_scale_ = 0, column_scale_ = 0; // strips and columns per unit, times 2^scale_bits
    base::Column<std::uint32_t> first_; // per cell: where its circles begin in order_; one more at the end
    base::Column<std::uint32_t> order_;
};

/// Pairs that may touch before any body has moved half the skin.
class NearPairs {
  public:
    struct Pair {
        std::uint32_t a, b; // indices
    };

    /// Whether pairs might touch that are not listed; always at first.
    bool worn(const Circles& circles, const Boxes& boxes) const;
    /// Makes worn() true: everything is new.
    void forget() {
        strayed_square_ = std::numeric_limits<float>::infinity();
        skin_share_ = 1;
    }
    /// The circle has become void: it has not strayed.
    void remove(std::size_t circle) { anchor_x_[circle] = anchor_y_[circle] = elsewhere; }
    /// What the next worn() goes by. strayed_square: of the circle furthest from its anchor, px².
    void circles_strayed(float strayed_square) { strayed_square_ = strayed_square; }

    /// All anew, from where bodies are: sort(), then list(). Who wants to reorder circles does so between the two.
    void renew(const Circles& circles, const Boxes& boxes, const Area& area, base::Executor& executor) {
        sort(circles, boxes, area, executor);
        list(circles, boxes, executor);
    }
    /// Takes the circles' present places for anchors and sorts them.
    void sort(const Circles& circles, const Boxes& boxes, const Area& area, base::Executor& executor);
    const Strips& strips() const { return strips_; }
    /// To be called when circles have been reordered by strips().order().
    void follow_reordering(const Circles& circles, base::Executor& executor);
    /// Lists the pairs as of the last sort().
    void list(const Circles& circles, const Boxes& boxes, base::Executor& executor);

    /// Pairs of circles, in as many parts as there are blocks of circles.
    std::span<const Pair> circle_pairs(std::size_t block) const { return pairs_of_block_[block]; }
    /// a is a circle, b a box.
    std::span<const Pair> circle_box_pairs() const { return circle_box_pairs_; }
    /// Boxes; at least one can move.
    std::span<const Pair> box_pairs() const { return box_pairs_; }

    const base::Column<Coordinate>& anchor_x() const { return anchor_x_; } // per circle
    const base::Column<Coordinate>& anchor_y() const { return anchor_y_; }
    float skin_px() const { return skin_px_; }

    /// Calls visit(stretch) for stretches that together hold every circle now at most `radius` px from (x, y), and
    /// others.
    template <class Visit>
    void for_each_stretch_near(Coordinate x, Coordinate y, float radius, Visit&& visit) const {
        const auto reach = static_cast<std::int64_t>((radius + std::sqrt(strayed_square_) + 0.1f) * units_per_px);
        strips_.for_each_stretch(x - reach, x + reach, y - reach, y + reach, visit);
    }

  private:
    void anchor(const Circles& circles, base::Executor& executor);
    bool list_circle_pairs(const Circles& circles, base::Executor& executor);
    void list_box_pairs(const Circles& circles, const Boxes& boxes);

    Strips strips_;
    base::Column<Coordinate> anchor_x_, anchor_y_;
    base::Column<Coordinate> box_anchor_x_, box_anchor_y_;
    std::size_t circle_count_ = 0;
    float strayed_square_ = std::numeric_limits<float>::infinity();
    float radius_max_ = 0; // px
    float skin_px_ = 0;
    float skin_share_ = 1; // of the skin that suits an even spread; less in crowds
    std::vector<std::vector<Pair>> pairs_of_block_;
    std::vector<Pair> circle_box_pairs_, box_pairs_;
    std::vector<std::uint32_t> boxes_by_left_;
};

} // namespace evod::physics
