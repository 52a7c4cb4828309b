// Items: the food, or the poison, of an island; they rest where they are, are eaten, and reappear.
//
// Those that are there lie in a uniform grid of buckets, eight items to a bucket, updated in place as items come and
// go.
//
// Threads      consume() and reappear() by one thread; queries by any number while nothing changes.
// Determinism  where an item reappears depends on (seed, island, generation, item, tick) alone; queries answer by
//              distance, then id, never by the order in a bucket.
#pragma once

#include "server/base/random.h"
#include "server/base/state_hash.h"
#include "server/physics/bodies.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace evod::simulation {

/// How items come into the world; the same for a whole generation.
struct ItemRules {
    base::Purpose placement, respawn_purpose; // which draws
    std::uint32_t kind;                       // in the state hash
    std::uint32_t count;
    float radius_px;
    bool respawn;
    std::uint32_t respawn_ticks; // from being eaten to the tick that begins with it there again, >= 1
};

class Items {
  public:
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

    /// Fresh items at uniform random places clear of walls and obstacles.
    void begin_generation(const ItemRules& rules, base::Seed seed, std::uint32_t island, std::uint64_t generation,
                          const physics::Area& area, const physics::Boxes& obstacles);

    /// Puts back what is due at the beginning of `tick`.
    void reappear(std::uint32_t tick, const physics::Boxes& obstacles);

    /// Takes away an item that is there, during `tick`.
    void consume(std::uint32_t item, std::uint32_t tick);

    struct Nearest {
        std::uint32_t item = none;
        float square = 0;     // of the distance, px²
        float dx = 0, dy = 0; // to the item, px
    };
    /// The nearest item whose centre is at most `radius` px from (x, y); of equally near ones the lowest id.
    Nearest nearest(physics::Coordinate x, physics::Coordinate y, float radius) const;

    /// Calls found(item, square of the distance) for every item whose centre is at most `radius` px from (x, y).
    template <class Found>
    void for_each_within(physics::Coordinate x, physics::Coordinate y, float radius, Found&& found) const {
        const float reach = radius * radius;
        for_each_bucket(x, y, radius, [&](std::uint32_t b) {
            const Places& places = places_[b];
            for (std::uint32_t slot = 0; slot < contents_[b].count; ++slot) {
                const float dx = physics::distance_px(x, places.x[slot]), dy = physics::distance_px(y, places.y[slot]);
                const float square = dx * dx + dy * dy;
                if (square <= reach)
                    found(contents_[b].item[slot], square);
            }
        });
    }

    std::uint32_t size() const { return static_cast<std::uint32_t>(x_.size()); } // there or not
    std::uint32_t present_count() const { return present_count_; }
    bool present(std::uint32_t item) const { return due_tick_[item] == 0; }
    const std::vector<std::uint32_t>& due_tick() const { return due_tick_; } // by id; 0: there
    const std::vector<physics::Coordinate>& x() const { return x_; }         // by id; of one that is away, where it was
    const std::vector<physics::Coordinate>& y() const { return y_; }
    float radius_px() const { return rules_.radius_px; }
    /// Of all items; kept up to date as they come and go.
    base::StateHash hash() const { return hash_; }

  private:
    static constexpr std::uint32_t slots = 8;
    // Where empty slots pretend to be: further from any place on an island than any radius reaches, so that a query can
    // look at all eight slots at once.
    static constexpr physics::Coordinate far_away = -(1 << 30);
    // A bucket in two parts, so that what every query reads lies close: one cache line a bucket, neighbours side by
    // side.
    struct alignas(64) Places {
        std::array<physics::Coordinate, slots> x, y;

        Places() {
            x.fill(far_away);
            y.fill(far_away);
        }
    };
    struct Contents {
        std::array<std::uint32_t, slots> item;
        std::uint32_t count = 0;
        std::uint32_t next = none; // bucket of the same cell that took what did not fit

        Contents() { item.fill(none); }
    };

    void choose_cells(std::uint32_t count);
    std::uint32_t cell_of(physics::Coordinate x, physics::Coordinate y) const;
    void insert(std::uint32_t item);
    void remove(std::uint32_t item);
    void settle(std::uint32_t item, base::RandomStream random, const physics::Boxes& obstacles);
    base::StateHash hash_of(std::uint32_t item) const;

    struct CellRange {
        std::uint32_t left, right, top, bottom; // all included
    };
    CellRange cells_within(physics::Coordinate x, physics::Coordinate y, float radius) const {
        // Islands and radii are small enough that neither sum leaves 32 bits (bodies.h).
        const auto reach = static_cast<physics::Coordinate>(radius * static_cast<float>(physics::units_per_px)) + 1;
        const auto cell = [this](physics::Coordinate position) {
            return static_cast<std::uint32_t>(std::max(position, 0)) >> shift_;
        };
        return {cell(x - reach), std::min(cell(x + reach), columns_ - 1), cell(y - reach),
                std::min(cell(y + reach), rows_ - 1)};
    }

    template <class Visit>
    void for_each_bucket(physics::Coordinate x, physics::Coordinate y, float radius, Visit&& visit) const {
        const CellRange cells = cells_within(x, y, radius);
        for (std::uint32_t row = cells.top; row <= cells.bottom; ++row)
            for (std::uint32_t column = cells.left; column <= cells.right; ++column)
                for (std::uint32_t b = row * columns_ + column; b != none;) {
                    visit(b);
                    // A look at the places, which are at hand, saves one at the contents of most buckets.
                    b = places_[b].x[slots - 1] == far_away ? none : contents_[b].next;
                }
    }

    ItemRules rules_{};
    physics::Area area_;
    base::RandomKey respawn_key_{base::Seed{}, base::Purpose::FoodRespawn, 0, 0};
    std::vector<physics::Coordinate> x_, y_;
    std::vector<std::uint32_t> due_tick_; // 0: there; else the tick at whose beginning it reappears
    struct Due {
        std::uint32_t tick, item;
    };
    std::vector<Due> due_; // in order of tick, from due_begin_
    std::size_t due_begin_ = 0;
    unsigned shift_ = 0; // a cell's side is 2^shift_ units
    std::uint32_t rows_ = 0, columns_ = 0;
    std::vector<Places> places_;       // buckets: one per cell, then those that took what did not fit
    std::vector<Contents> contents_;   // of the same buckets
    std::vector<std::uint32_t> spare_; // of the latter, those that are empty
    std::uint32_t present_count_ = 0;
    base::StateHash hash_;
};

} // namespace evod::simulation
