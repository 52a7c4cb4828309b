// PlaceGrid: what has been put down on an island, in square cells, so that asking what is near a place costs the same
// however much there is.
//
// A cell is one cache line, and a place asks few of them, so that a caller with many places to try can fetch the lines
// of all of them before it asks for the first.
//
// Threads      queries by any number while nothing is added.
// Determinism  a query is whether anything fulfils a condition, so neither cells nor the order in them show.
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

/// What  is kept beside the place of each thing: 4 or 8 bytes that say how large it is.
template <class What>
class PlaceGrid {
  public:
    PlaceGrid() = default;

    /// expected_count  how many things will be put down; five to two cells.
    PlaceGrid(const physics::Area& area, std::size_t expected_count) {
        const double width = std::max(area.width, 1), height = std::max(area.height, 1);
        const double cells = std::max(static_cast<double>(expected_count) / 2.5, 1.0);
        const double columns = std::clamp(std::floor(std::sqrt(cells * width / height)), 1.0, cells);
        columns_ = {.count = static_cast<std::uint32_t>(columns), .length = area.width};
        rows_ = {.count = static_cast<std::uint32_t>(std::floor(cells / columns)), .length = area.height};
        cells_.resize(std::size_t{columns_.count} * rows_.count);
    }

    bool empty() const { return count_ == 0; }

    void add(Place place, What what) {
        std::size_t cell = std::size_t{rows_.at(place.y)} * columns_.count + columns_.at(place.x);
        while (cells_[cell].things[slots - 1].place.x != nowhere) {
            if (cells_[cell].next == 0) {
                const auto added = static_cast<std::uint32_t>(cells_.size());
                cells_.emplace_back();
                cells_[cell].next = added;
            }
            cell = cells_[cell].next;
        }
        const auto free = std::find_if(cells_[cell].things.begin(), cells_[cell].things.end(),
                                       [](const Thing& thing) { return thing.place.x == nowhere; });
        *free = {place, what};
        ++count_;
    }

    /// Whether condition(place, what) holds for anything whose centre is at most `reach` units from `place` along both
    /// axes; it may be asked of things further away too, and must not hold for one of size 0 that is far away. The cell
    /// of `place` itself is asked first: where it is crowded, that is where the answer most often lies.
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

    /// Has the cells fetched that any_near would ask.
    void prefetch(Place place, physics::Coordinate reach) const {
        const Window window = window_of(place, reach);
        for (std::uint32_t row = window.top; row <= window.bottom; ++row) {
            for (std::uint32_t column = window.left; column <= window.right; ++column) {
                __builtin_prefetch(&cells_[std::size_t{row} * columns_.count + column]);
            }
        }
    }

  private:
    // Where empty slots pretend to be: so far beyond the wall that no radius reaches them, so near that no difference
    // from a place on an island leaves 32 bits.
    static constexpr physics::Coordinate nowhere = -(1 << 26);
    struct Thing {
        Place place{nowhere, nowhere};
        What what{};
    };
    static constexpr std::size_t slots = (64 - sizeof(std::uint32_t)) / sizeof(Thing);
    struct alignas(64) Cell {
        std::array<Thing, slots> things; // those that are there first
        std::uint32_t next = 0;          // the cell that took what did not fit; 0: none
    };
    static_assert(sizeof(Cell) == 64);

    /// The stripes into which one side of the area is cut.
    struct Stripes {
        std::uint32_t count = 1;
        physics::Coordinate length = 0;
        std::uint64_t per_unit = (std::uint64_t{count} << 32) / (static_cast<std::uint64_t>(length) + 1); // · 2^-32

        std::uint32_t at(physics::Coordinate coordinate) const {
            const auto inside = static_cast<std::uint64_t>(std::clamp(coordinate, 0, length));
            return static_cast<std::uint32_t>(inside * per_unit >> 32);
        }
    };
    struct Window {
        std::uint32_t left, right, top, bottom; // all included
    };
    Window window_of(Place place, physics::Coordinate reach) const {
        return {columns_.at(place.x - reach), columns_.at(place.x + reach), rows_.at(place.y - reach),
                rows_.at(place.y + reach)};
    }

    // All slots of a cell are asked, as a branch for each would be mispredicted too often.
    template <class Condition>
    bool any_in(std::size_t cell, const Condition& condition) const {
        do {
            bool found = false;
            for (const Thing& thing : cells_[cell].things) {
                found |= condition(thing.place, thing.what);
            }
            if (found) {
                return true;
            }
            cell = cells_[cell].next;
        } while (cell != 0);
        return false;
    }

    Stripes columns_, rows_;
    std::vector<Cell> cells_; // row by row; then those that took what did not fit
    std::size_t count_ = 0;
};

} // namespace evod::simulation
