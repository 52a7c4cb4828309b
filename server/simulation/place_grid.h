// PlaceGrid: stores the bodies already placed on an island in square cells, so that the cost of a search near a place
// does not depend on the number of bodies.
//
// A cell is one cache line, and a search reads few cells. A caller with many places to try can therefore prefetch the
// cells of all of them before the first search.
//
// Threads      any number of threads may search while nothing is added.
// Determinism  a search returns whether any body fulfils a condition, so neither the cells nor their order affect the
//              result.
#pragma once

#include "server/physics/bodies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace evod::simulation {

struct Place {
    physics::Coordinate x, y;
};

/// Size  the type that describes the size of a body; 4 or 8 bytes. The grid stores a Size with each place.
template <class Size>
class PlaceGrid {
  public:
    PlaceGrid() = default;

    /// Creates an empty grid for about expected_count bodies: on average five bodies per two cells.
    PlaceGrid(const physics::Area& area, std::size_t expected_count) {
        const double width = std::max(area.width, 1), height = std::max(area.height, 1);
        const double cells = std::max(static_cast<double>(expected_count) / 2.5, 1.0);
        const double columns = std::clamp(std::floor(std::sqrt(cells * width / height)), 1.0, cells);
        columns_ = {.count = static_cast<std::uint32_t>(columns), .length = area.width};
        rows_ = {.count = static_cast<std::uint32_t>(std::floor(cells / columns)), .length = area.height};
        cells_.resize(std::size_t{columns_.count} * rows_.count);
    }

    bool empty() const { return count_ == 0; }

    void add(Place place, Size size) {
        std::size_t cell = std::size_t{rows_.at(place.y)} * columns_.count + columns_.at(place.x);
        while (cells_[cell].bodies[slots - 1].place.x != nowhere) {
            if (cells_[cell].next == 0) {
                const auto added = static_cast<std::uint32_t>(cells_.size());
                cells_.emplace_back();
                cells_[cell].next = added;
            }
            cell = cells_[cell].next;
        }
        const auto free = std::find_if(cells_[cell].bodies.begin(), cells_[cell].bodies.end(),
                                       [](const StoredBody& body) { return body.place.x == nowhere; });
        *free = {place, size};
        ++count_;
    }

    /// Returns whether condition(place, size) is true for any body whose centre is at most `reach` units from `place`
    /// along both axes. The condition may also be called for bodies further away, and must be false for a body of size
    /// 0 that is far away. The cell of `place` is searched first: in crowds the answer is most often found there.
    template <class Condition>
    bool any_near(Place place, physics::Coordinate reach, const Condition& condition) const {
        const Window window = window_of(place, reach);
        const std::size_t own = std::size_t{rows_.at(place.y)} * columns_.count + columns_.at(place.x);
        if (any_in(own, condition)) {
            return true;
        }
        for (std::uint32_t row = window.top; row <= window.bottom; ++row) {
            for (std::uint32_t column = window.left; column <= window.right; ++column) {
                if (const std::size_t cell = std::size_t{row} * columns_.count + column;
                    cell != own && any_in(cell, condition)) {
                    return true;
                }
            }
        }
        return false;
    }

    /// Prefetches the cells that any_near would search.
    void prefetch(Place place, physics::Coordinate reach) const {
        const Window window = window_of(place, reach);
        for (std::uint32_t row = window.top; row <= window.bottom; ++row) {
            for (std::uint32_t column = window.left; column <= window.right; ++column) {
                __builtin_prefetch(&cells_[std::size_t{row} * columns_.count + column]);
            }
        }
    }

  private:
    // The position of empty slots. It is so far beyond the wall that no radius reaches it, and so near that its
    // difference from any place on an island fits into 32 bits.
    static constexpr physics::Coordinate nowhere = -(1 << 26);
    struct StoredBody {
        Place place{nowhere, nowhere};
        Size size{};
    };
    static constexpr std::size_t slots = (64 - sizeof(std::uint32_t)) / sizeof(StoredBody);
    struct alignas(64) Cell {
        std::array<StoredBody, slots> bodies; // used slots come first
        std::uint32_t next = 0;               // the overflow cell; 0: none
    };
    static_assert(sizeof(Cell) == 64);

    /// The stripes that one side of the area is divided into.
    struct Stripes {
        std::uint32_t count = 1;
        physics::Coordinate length = 0;
        // The number of stripes per unit of length, times 2^32.
        std::uint64_t per_unit = (std::uint64_t{count} << 32) / (static_cast<std::uint64_t>(length) + 1);

        std::uint32_t at(physics::Coordinate coordinate) const {
            const auto inside = static_cast<std::uint64_t>(std::clamp(coordinate, 0, length));
            return static_cast<std::uint32_t>(inside * per_unit >> 32);
        }
    };
    struct Window {
        std::uint32_t left, right, top, bottom; // all inclusive
    };
    Window window_of(Place place, physics::Coordinate reach) const {
        return {columns_.at(place.x - reach), columns_.at(place.x + reach), rows_.at(place.y - reach),
                rows_.at(place.y + reach)};
    }

    // Tests all slots of a cell, because a branch for each would be mispredicted too often.
    template <class Condition>
    bool any_in(std::size_t cell, const Condition& condition) const {
        do {
            bool found = false;
            for (const StoredBody& body : cells_[cell].bodies) {
                found |= condition(body.place, body.size);
            }
            if (found) {
                return true;
            }
            cell = cells_[cell].next;
        } while (cell != 0);
        return false;
    }

    Stripes columns_, rows_;
    std::vector<Cell> cells_; // row by row; then the overflow cells
    std::size_t count_ = 0;
};

} // namespace evod::simulation
