// Items: the food or the poison of an island, in a uniform grid of buckets of eight items. The grid is updated in place
// when items disappear and reappear.
//
// Threads      set_due() may run in parallel for different items. consume(), take_out() and reappear() need a single
//              caller. Any number of threads may query while nothing changes.
// Determinism  the place where an item reappears depends on (seed, island, generation, item, tick) alone. Queries
//              select by distance, then by id, never by the order in a bucket.
#pragma once

#include "server/base/column.h"
#include "server/base/executor.h"
#include "server/base/random.h"
#include "server/base/state_hash.h"
#include "server/physics/bodies.h"
#include "server/simulation/items_kernels.h"
#include "server/simulation/placement.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace evod::simulation {

/// The rules of items of one kind, constant during a generation.
struct ItemRules {
    base::Purpose placement, respawn_purpose; // purposes of the draws
    std::uint32_t kind;                       // kind of entity in the state hash
    std::uint32_t count;
    float radius_px;
    float margin_px = 0;         // centres are at least this far from walls, also if the radius is less
    bool respawn;                // false: no item reappears
    std::uint32_t respawn_ticks; // >= 1; an item eaten in tick t reappears at the beginning of tick t + respawn_ticks
};

class Items {
  public:
    static constexpr std::uint32_t none = no_item;

    /// Places new items uniformly at random, clear of walls and obstacles.
    void begin_generation(const ItemRules& rules, base::Seed seed, std::uint32_t island, std::uint64_t generation,
                          const physics::Area& area, const BoxGrid& obstacles, base::Executor& executor);

    /// Places new items at `places`, which has rules.count elements. Reappearing items use the random draws of island
    /// 0, generation 1.
    void begin_at(const ItemRules& rules, std::span<const Place> places, base::Seed seed, const physics::Area& area,
                  base::Executor& executor);

    struct Item {
        physics::Coordinate x, y; // position; of an absent item, its last position
        std::uint32_t due_tick;   // 0: present; `none`: never; otherwise the tick at whose beginning it reappears
        friend bool operator==(const Item&, const Item&) = default;
    };
    /// Returns why `items` cannot be the items after `tick` of the generation; nullptr if they can. If `resting` is
    /// true, items that are due need not have reappeared.
    const char* fault_of(std::span<const Item> items, std::uint32_t tick, bool resting) const;
    /// Sets the items; fault_of() must have accepted them.
    void restore(std::span<const Item> items, base::Executor& executor);

    /// Lets the items that are due at the beginning of `tick` reappear, each at a new random place.
    void reappear(std::uint32_t tick, const BoxGrid& obstacles, base::Executor& executor);

    /// Adds an item that does not reappear, between two ticks. Returns its id: the next one.
    std::uint32_t add(Place place);
    /// Removes an item between two ticks; it does not reappear in this generation. The item must be present.
    void remove(std::uint32_t item);

    /// Removes an item that an organism eats in `tick`. The item must be present.
    void consume(std::uint32_t item, std::uint32_t tick);

    // set_due() and take_out() are the two parts of consume(), for many items.
    /// Sets the tick at which an item that is eaten in `tick` reappears. Several threads may call this function for
    /// different items. Returns the change of the hash.
    base::StateHash set_due(std::uint32_t item, std::uint32_t tick);
    /// Removes an item from the grid. Only one thread at a time may call this function. `place` is the place of the
    /// item before any item was removed in this tick.
    void take_out(std::uint32_t item, std::uint32_t place);
    void add_to_hash(const base::StateHash& change) { hash_ += change; }
    /// Prefetches the memory that take_out() reads.
    void prefetch_place(std::uint32_t place) const {
        __builtin_prefetch(&bucket(place / slots), 1);
        __builtin_prefetch(&items_[place / slots], 1);
        __builtin_prefetch(&counts_[place / slots], 1);
        __builtin_prefetch(&next_[place / slots]);
    }
    /// Prefetches the item that set_due() writes.
    void prefetch_item(std::uint32_t item) const { __builtin_prefetch(&all_[item], 1); }

    /// Prefetches the memory that a query at (x, y) will read.
    void prefetch(physics::Coordinate x, physics::Coordinate y) const {
        __builtin_prefetch(&bucket(row_at(y) * columns_ + column_at(x)));
    }

    /// Returns the nearest item whose centre is at most `radius` px from (x, y), and a lower bound on the distance of
    /// all other items.
    TwoNearest two_nearest(physics::Coordinate x, physics::Coordinate y, float radius) const {
        TwoNearest found;
        const ItemQuery query{x, y, radius};
        items_kernels().two_nearest(grid(), &query, &found, 1);
        return found;
    }
    /// Returns the item at `place`, a TwoNearest::place; `none` if that is none.
    std::uint32_t item_at(std::uint32_t place) const {
        return place == none ? none : items_[place / slots][place % slots];
    }
    /// Returns the grid in the form that items_kernels() read, for many queries. The result is valid until an item is
    /// added.
    ItemGrid grid() const;

    /// Calls found(item, its place, square of the distance) for every item whose centre is at most `radius` px from (x,
    /// y).
    template <class Found>
    void for_each_within(physics::Coordinate x, physics::Coordinate y, float radius, Found&& found) const {
        const float within = radius * radius;
        const auto reach = static_cast<std::int64_t>(radius * static_cast<float>(physics::units_per_px)) + 1;
        const std::uint32_t right = column_at(x + reach), bottom = row_at(y + reach);
        for (std::uint32_t row = row_at(y - reach); row <= bottom; ++row) {
            for (std::uint32_t column = column_at(x - reach); column <= right; ++column) {
                for (std::uint32_t b = row * columns_ + column; b != none;) {
                    // For most buckets only the positions are read.
                    const ItemBucket& places = bucket(b);
                    for (std::uint32_t slot = 0; slot < slots && places.x[slot] != physics::void_position; ++slot) {
                        const float dx = physics::distance_px(x, places.x[slot]),
                                    dy = physics::distance_px(y, places.y[slot]);
                        const float square = dx * dx + dy * dy;
                        if (square <= within) {
                            found(items_[b][slot], b * slots + slot, square);
                        }
                    }
                    b = places.x[slots - 1] == physics::void_position ? none : next_[b];
                }
            }
        }
    }

    /// Changes since forget_changes(), in order.
    using Change = ItemChange;
    const std::vector<Change>& changes() const { return changes_; }
    void forget_changes() { changes_.clear(); }

    std::uint32_t size() const { return static_cast<std::uint32_t>(all_.size()); } // present and absent items
    /// Items at the beginning of the generation. They have the lowest ids; the others were added.
    std::uint32_t first_count() const { return rules_.count; }
    std::uint32_t present_count() const { return present_count_; }
    bool present(std::uint32_t item) const { return all_[item].due_tick == 0; }
    const base::Column<Item>& all() const { return all_; } // all items, by id
    float radius_px() const { return rules_.radius_px; }
    /// The hash of all items; updated when an item disappears or reappears.
    base::StateHash hash() const { return hash_; }

  private:
    static constexpr std::uint32_t slots = ItemBucket::slots;

    template <class PlaceOf>
    void begin(const ItemRules& rules, const base::RandomKey& respawn_key, const physics::Area& area,
               base::Executor& executor, PlaceOf&& place_of);
    /// Replaces all items. item_of(id) must return the new state of an item.
    template <class ItemOf>
    void put_all(base::Executor& executor, ItemOf&& item_of);
    void choose_cells(std::uint32_t count);
    std::uint32_t column_at(std::int64_t x) const { return index_at(x, columns_); } // clamped into the grid
    std::uint32_t row_at(std::int64_t y) const { return index_at(y, rows_); }
    std::uint32_t index_at(std::int64_t position, std::uint32_t count) const {
        const auto inside = static_cast<std::uint64_t>(std::clamp<std::int64_t>(position, 0, 0x7fff'ffff));
        return static_cast<std::uint32_t>(std::min<std::uint64_t>(inside * scale_ >> ItemGrid::scale_bits, count - 1));
    }
    ItemBucket& bucket(std::uint32_t b) { return buckets_[std::size_t{b} + 1]; }
    const ItemBucket& bucket(std::uint32_t b) const { return buckets_[std::size_t{b} + 1]; }
    /// Inserts all present items.
    void insert_all(base::Executor& executor);
    void insert(std::uint32_t item, std::uint32_t cell);
    std::uint32_t cell_of(std::uint32_t item) const {
        return row_at(all_[item].y) * columns_ + column_at(all_[item].x);
    }
    base::StateHash hash_of(std::uint32_t item) const;

    ItemRules rules_{};
    physics::Area area_;
    base::RandomKey respawn_key_{base::Seed{}, base::Purpose::FoodRespawn, 0, 0};
    base::Column<Item> all_;
    struct Due {
        std::uint32_t tick, item;
    };
    std::vector<Due> due_; // sorted by tick, from index due_begin_ on
    std::size_t due_begin_ = 0;
    std::int64_t side_ = 1; // side of a cell, as in ItemGrid
    std::uint64_t scale_ = 0;
    std::uint32_t rows_ = 0, columns_ = 0;
    // Element 0 of buckets_ is an empty bucket; bucket b of the grid (ItemGrid) is element b + 1. Every query reads
    // buckets_, so the other data of buckets is stored separately.
    base::Column<ItemBucket> buckets_;
    base::Column<std::array<std::uint32_t, slots>> items_;
    base::Column<std::uint32_t> next_;
    base::Column<std::uint8_t> counts_;
    std::vector<std::uint32_t> spare_; // overflow buckets that are empty, for reuse
    struct Arrival {
        std::uint32_t item, cell;
    };
    std::vector<Arrival> arrivals_; // working memory
    std::vector<base::StateHash> hash_of_piece_;
    std::vector<Change> changes_;
    std::uint32_t present_count_ = 0;
    base::StateHash hash_;
};

} // namespace evod::simulation
