#include "server/network/snapshot_columns.h"

#include <algorithm>
#include <bit>
#include <span>

namespace evod::network {
namespace {

wire::BoxColumns columns_of(const runtime::BoxesSnapshot& boxes, std::size_t begin, std::size_t end) {
    const auto part = [=](const auto& column) { return std::span{column}.subspan(begin, end - begin); };
    return {part(boxes.x), part(boxes.y), part(boxes.half_width_px), part(boxes.half_height_px)};
}

/// Room for `count`, and for one more: what is to be left out is written there and written over.
template <class... Columns>
void make_room(std::size_t count, Columns&... columns) {
    (columns.resize(std::max(columns.size(), count + 1)), ...);
}

} // namespace

wire::ItemColumns SnapshotColumns::put_in_order(const runtime::ItemsSnapshot& items, Items& to) {
    make_room(items.present_count, to.id, to.x, to.y);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < items.all.size(); ++i) { // without a branch: which items are away is unpredictable
        const simulation::Items::Item& item = items.all[i];
        to.id[kept] = static_cast<std::uint32_t>(i);
        to.x[kept] = item.x;
        to.y[kept] = item.y;
        kept += item.due_tick == 0;
    }
    return {std::span{to.id}.first(kept), std::span{to.x}.first(kept), std::span{to.y}.first(kept)};
}

wire::OrganismColumns SnapshotColumns::put_in_order(const runtime::OrganismsSnapshot& organisms) {
    std::uint32_t largest_id = 0;
    for (const std::uint32_t id : organisms.id)
        largest_id = std::max(largest_id, id);
    by_id_.assign(organisms.id.empty() ? 0 : std::size_t{largest_id} + 1, Organism{});
    for (std::size_t i = 0; i < organisms.id.size(); ++i)
        if (organisms.x[i] != physics::elsewhere)
            by_id_[organisms.id[i]] = {organisms.x[i], organisms.y[i], organisms.radius_px[i], organisms.health[i]};
    auto& [id, x, y, radius_px, health] = organisms_;
    make_room(organisms.alive_count, id, x, y, radius_px, health);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < by_id_.size(); ++i) { // without a branch, as above
        const Organism& organism = by_id_[i];
        id[kept] = static_cast<std::uint32_t>(i);
        x[kept] = organism.x;
        y[kept] = organism.y;
        radius_px[kept] = organism.radius_px;
        health[kept] = organism.health;
        kept += organism.x != physics::elsewhere;
    }
    const auto first = [kept](const auto& column) { return std::span{column}.first(kept); };
    return {first(id), first(x), first(y), first(radius_px), first(health)};
}

wire::IslandColumns SnapshotColumns::of(const runtime::IslandSnapshot& island) {
    const std::size_t crates = island.crate_count, boxes = island.boxes.x.size();
    return {.width_px = island.width_px,
            .height_px = island.height_px,
            .position_fraction_bits = std::countr_zero(static_cast<unsigned>(physics::units_per_px)),
            .organisms = put_in_order(island.organisms),
            .food = put_in_order(island.food, food_),
            .poison = put_in_order(island.poison, poison_),
            .crates = columns_of(island.boxes, 0, crates),
            .obstacles = columns_of(island.boxes, crates, boxes)};
}

} // namespace evod::network
