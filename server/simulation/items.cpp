#include "server/simulation/items.h"

#include "server/base/assert.h"
#include "server/base/commutative.h"
#include "server/base/instructions.h"
#include "server/simulation/commands.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace evod::simulation {

using physics::Coordinate;

extern const ItemsKernels items_kernels_baseline, items_kernels_avx2;

const ItemsKernels& items_kernels() {
    // A bucket has eight slots, so these kernels do not use wider vectors than those of AVX2.
    return base::chosen(items_kernels_baseline, items_kernels_avx2, items_kernels_avx2);
}

namespace {

constexpr std::uint32_t items_per_block = 4096;
constexpr std::size_t prefetched_ahead = 8; // number of items

constexpr ItemBucket empty_bucket() {
    ItemBucket bucket{};
    for (std::uint32_t slot = 0; slot < ItemBucket::slots; ++slot) {
        bucket.x[slot] = bucket.y[slot] = physics::void_position;
    }
    return bucket;
}

} // namespace

void Items::begin_generation(const ItemRules& rules, base::Seed seed, std::uint32_t island, std::uint64_t generation,
                             const physics::Area& area, const BoxGrid& obstacles, base::Executor& executor) {
    const base::RandomKey key{seed, rules.placement, island, generation};
    begin(rules, {seed, rules.respawn_purpose, island, generation}, area, executor, [&](std::uint32_t item) {
        base::RandomStream random{key, item};
        return random_place(random, area, rules.radius_px, obstacles, rules.margin_px);
    });
}

void Items::begin_at(const ItemRules& rules, std::span<const Place> places, base::Seed seed, const physics::Area& area,
                     base::Executor& executor) {
    EVOD_ASSERT(places.size() == rules.count);
    begin(rules, {seed, rules.respawn_purpose, 0, 1}, area, executor, [&](std::uint32_t item) { return places[item]; });
}

template <class PlaceOf>
void Items::begin(const ItemRules& rules, const base::RandomKey& respawn_key, const physics::Area& area,
                  base::Executor& executor, PlaceOf&& place_of) {
    rules_ = rules;
    area_ = area;
    respawn_key_ = respawn_key;
    all_.resize(rules.count);
    put_all(executor, [&](std::uint32_t item) {
        const Place place = place_of(item);
        return Item{place.x, place.y, 0};
    });
    present_count_ = rules.count;
}

template <class ItemOf>
void Items::put_all(base::Executor& executor, ItemOf&& item_of) {
    const auto count = static_cast<std::uint32_t>(all_.size());
    due_.clear();
    due_begin_ = 0;
    changes_.clear();
    choose_cells(count);

    std::vector<base::StateHash> hash_of_block((count + items_per_block - 1) / items_per_block);
    executor.parallel_for(count, items_per_block, [&](base::Range range) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            const auto item = static_cast<std::uint32_t>(i);
            all_[item] = item_of(item);
            hash_of_block[range.begin / items_per_block] += hash_of(item);
        }
    });
    hash_ = {};
    for (const base::StateHash& hash : hash_of_block) {
        hash_ += hash;
    }
    insert_all(executor);
}

const char* Items::fault_of(std::span<const Item> items, std::uint32_t tick, bool resting) const {
    if (items.size() < rules_.count || items.size() - rules_.count > placed_max) {
        return "number of items";
    }
    const std::uint64_t last_due = std::uint64_t{tick} + rules_.respawn_ticks;
    for (std::size_t id = 0; id < items.size(); ++id) {
        const Item& item = items[id];
        // Items do not touch the walls, so no item is at (0, 0), which Perception uses for void bodies.
        if (item.x <= 0 || item.x >= area_.width || item.y <= 0 || item.y >= area_.height) {
            return "position of an item";
        }
        const bool reappears = (rules_.respawn || item.due_tick == 1) && id < rules_.count &&
                               item.due_tick <= last_due && (item.due_tick > tick || resting);
        if (item.due_tick != 0 && item.due_tick != none && !reappears) {
            return "due tick of an item";
        }
    }
    return nullptr;
}

void Items::restore(std::span<const Item> items, base::Executor& executor) {
    all_.resize(items.size());
    put_all(executor, [&](std::uint32_t item) { return items[item]; });
    present_count_ = 0;
    for (std::uint32_t item = 0; item < size(); ++item) {
        if (present(item)) {
            ++present_count_;
        } else if (all_[item].due_tick != none) {
            due_.push_back({all_[item].due_tick, item});
        }
    }
    std::ranges::sort(due_, {}, [](const Due& due) { return std::tie(due.tick, due.item); });
}

void Items::choose_cells(std::uint32_t count) {
    // About four items per cell where items are placed. Few buckets then overflow, and a query whose radius is at most
    // the side of a cell reads at most four cells. There are at most 16 cells for one in which items are placed.
    const double margin = 2.0 * physics::to_units(rules_.margin_px);
    const double area = static_cast<double>(area_.width) * area_.height;
    const double share =
        4 * std::max((area_.width - margin) * (area_.height - margin), area / 16) / std::max(count, 1u);
    side_ = static_cast<std::int64_t>(std::clamp(std::sqrt(share), 4096.0, 1073741824.0));
    scale_ = (std::uint64_t{1} << ItemGrid::scale_bits) / static_cast<std::uint64_t>(side_);
    const auto cells = [this](Coordinate size) {
        return static_cast<std::uint32_t>(static_cast<std::uint64_t>(size) * scale_ >> ItemGrid::scale_bits) + 1;
    };
    columns_ = cells(area_.width);
    rows_ = cells(area_.height);
    const std::size_t cell_count = std::size_t{rows_} * columns_;
    // Reserves room for overflow buckets. It is enough for evenly distributed items; obstacles may crowd items
    // together.
    const std::size_t room = cell_count + cell_count / 16 + 16;
    buckets_.reserve(room + 1);
    items_.reserve(room);
    next_.reserve(room);
    counts_.reserve(room);
    buckets_.assign(cell_count + 1, empty_bucket());
    items_.assign(cell_count, {});
    next_.assign(cell_count, none);
    counts_.assign(cell_count, 0);
    spare_.clear();
    spare_.reserve(room - cell_count);
    // Reserves enough for the items that disappear and reappear in a tick, unless organisms eat nearly all items at
    // once.
    const std::size_t events = count / 16 + 64;
    changes_.reserve(2 * events);
    due_.reserve(events);
    arrivals_.reserve(events);
}

ItemGrid Items::grid() const {
    return {.buckets = buckets_.data() + 1,
            .items = reinterpret_cast<const std::uint32_t(*)[slots]>(items_.data()),
            .next = next_.data(),
            .rows = rows_,
            .columns = columns_,
            .side = side_,
            .scale = scale_};
}

void Items::insert_all(base::Executor& executor) {
    // The first item to arrive gets the first slot. An item without a slot waits until all other items are inserted.
    std::vector<std::vector<std::uint32_t>> waiting((all_.size() + items_per_block - 1) / items_per_block);
    executor.parallel_for(all_.size(), items_per_block, [&](base::Range range) {
        std::vector<std::uint32_t>& no_slot = waiting[range.begin / items_per_block];
        for (std::size_t i = range.begin; i < range.end; ++i) {
            if (i + prefetched_ahead < range.end) {
                const std::uint32_t cell = cell_of(static_cast<std::uint32_t>(i + prefetched_ahead));
                __builtin_prefetch(&bucket(cell), 1);
                __builtin_prefetch(&items_[cell], 1);
            }
            const auto item = static_cast<std::uint32_t>(i);
            if (!present(item)) {
                continue;
            }
            const std::uint32_t cell = cell_of(item);
            if (base::load_shared(counts_[cell]) >= slots) {
                no_slot.push_back(item);
                continue;
            }
            const std::uint32_t slot = base::fetch_add<true>(counts_[cell], std::uint8_t{1});
            if (slot >= slots) {
                base::fetch_add<true>(counts_[cell], std::uint8_t{255}); // − 1
                no_slot.push_back(item);
                continue;
            }
            bucket(cell).x[slot] = all_[item].x;
            bucket(cell).y[slot] = all_[item].y;
            items_[cell][slot] = item;
        }
    });
    for (const std::vector<std::uint32_t>& no_slot : waiting) {
        for (const std::uint32_t item : no_slot) {
            insert(item, cell_of(item));
        }
    }
}

void Items::insert(std::uint32_t item, std::uint32_t cell) {
    std::uint32_t b = cell;
    while (counts_[b] == slots) {
        if (next_[b] == none) {
            std::uint32_t added;
            if (spare_.empty()) {
                added = static_cast<std::uint32_t>(next_.size());
                buckets_.push_back(empty_bucket());
                items_.push_back({});
                next_.push_back(none);
                counts_.push_back(0);
            } else {
                added = spare_.back();
                spare_.pop_back();
            }
            next_[b] = added;
        }
        b = next_[b];
    }
    const std::uint32_t slot = counts_[b]++;
    bucket(b).x[slot] = all_[item].x;
    bucket(b).y[slot] = all_[item].y;
    items_[b][slot] = item;
}

void Items::take_out(std::uint32_t item, std::uint32_t place) {
    // Earlier removals may have moved the item to another place of its cell.
    std::uint32_t holder = place / slots, slot = place % slots;
    const std::uint32_t cell = holder < std::size_t{rows_} * columns_ ? holder : cell_of(item);
    if (items_[holder][slot] != item || slot >= counts_[holder]) {
        for (holder = cell;; holder = next_[holder]) {
            EVOD_ASSERT(holder != none);
            const auto end_of_items = items_[holder].begin() + counts_[holder];
            const auto found = std::find(items_[holder].begin(), end_of_items, item);
            if (found == end_of_items) {
                continue;
            }
            slot = static_cast<std::uint32_t>(found - items_[holder].begin());
            break;
        }
    }
    changes_.push_back({bucket(holder).x[slot], bucket(holder).y[slot], false});
    if (all_[item].due_tick != none) {
        due_.push_back({all_[item].due_tick, item});
    }
    --present_count_;

    // Only the last bucket of a cell is ever partly filled: its last item fills the gap.
    std::uint32_t last = cell, before_last = none;
    while (next_[last] != none) {
        before_last = std::exchange(last, next_[last]);
    }
    const std::uint32_t end = --counts_[last];
    bucket(holder).x[slot] = bucket(last).x[end];
    bucket(holder).y[slot] = bucket(last).y[end];
    items_[holder][slot] = items_[last][end];
    bucket(last).x[end] = bucket(last).y[end] = physics::void_position;
    if (end == 0 && before_last != none) {
        next_[before_last] = none;
        spare_.push_back(last);
    }
}

base::StateHash Items::set_due(std::uint32_t item, std::uint32_t tick) {
    EVOD_ASSERT(present(item));
    base::StateHash change;
    change -= hash_of(item);
    all_[item].due_tick = rules_.respawn && item < rules_.count ? tick + rules_.respawn_ticks : none;
    change += hash_of(item);
    return change;
}

std::uint32_t Items::add(Place place) {
    const std::uint32_t item = size();
    all_.push_back({place.x, place.y, 0});
    hash_ += hash_of(item);
    insert(item, cell_of(item));
    changes_.push_back({place.x, place.y, true});
    ++present_count_;
    return item;
}

void Items::remove(std::uint32_t item) {
    EVOD_ASSERT(present(item));
    hash_ -= hash_of(item);
    all_[item].due_tick = none;
    hash_ += hash_of(item);
    take_out(item, cell_of(item) * slots);
}

void Items::consume(std::uint32_t item, std::uint32_t tick) {
    add_to_hash(set_due(item, tick));
    take_out(item, cell_of(item) * slots);
}

void Items::reappear(std::uint32_t tick, const BoxGrid& obstacles, base::Executor& executor) {
    std::size_t due_end = due_begin_;
    while (due_end < due_.size() && due_[due_end].tick <= tick) {
        ++due_end;
    }
    if (due_end == due_begin_) {
        return;
    }
    // Places and hashes are computed in parallel. The items are then inserted into the buckets one by one.
    constexpr std::size_t grain = 256;
    const std::size_t count = due_end - due_begin_;
    arrivals_.resize(count);
    hash_of_piece_.assign((count + grain - 1) / grain, {});
    executor.parallel_for(count, grain, [&](base::Range range) {
        for (std::size_t k = range.begin; k < range.end; ++k) {
            prefetch_item(due_[due_begin_ + k].item);
        }
        for (std::size_t k = range.begin; k < range.end; ++k) {
            const std::uint32_t item = due_[due_begin_ + k].item;
            base::StateHash& hash = hash_of_piece_[k / grain];
            hash -= hash_of(item);
            base::RandomStream random{respawn_key_, item, tick};
            const Place place = random_place(random, area_, rules_.radius_px, obstacles, rules_.margin_px);
            all_[item] = {place.x, place.y, 0};
            hash += hash_of(item);
            arrivals_[k] = {item, cell_of(item)};
        }
    });
    for (const base::StateHash& hash : hash_of_piece_) {
        hash_ += hash;
    }
    for (std::size_t k = 0; k < count; ++k) {
        if (k + prefetched_ahead < count) {
            const std::uint32_t cell = arrivals_[k + prefetched_ahead].cell;
            __builtin_prefetch(&bucket(cell), 1);
            __builtin_prefetch(&items_[cell], 1);
            __builtin_prefetch(&counts_[cell], 1);
        }
        const auto [item, cell] = arrivals_[k];
        insert(item, cell);
        changes_.push_back({all_[item].x, all_[item].y, true});
    }
    present_count_ += static_cast<std::uint32_t>(count);

    due_begin_ = due_end;
    if (due_begin_ == due_.size()) {
        due_.clear();
        due_begin_ = 0;
    } else if (due_begin_ > 64 && due_begin_ * 2 > due_.size()) {
        due_.erase(due_.begin(), due_.begin() + static_cast<std::ptrdiff_t>(due_begin_));
        due_begin_ = 0;
    }
}

base::StateHash Items::hash_of(std::uint32_t item) const {
    base::EntityHash hash{rules_.kind, item};
    if (present(item)) {
        hash.add(all_[item].x, all_[item].y);
    } else {
        hash.add(std::uint64_t{all_[item].due_tick});
    }
    return hash.finish();
}

} // namespace evod::simulation
