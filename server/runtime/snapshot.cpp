#include "server/runtime/snapshot.h"

#include <cstddef>
#include <utility>

namespace evod::runtime {
namespace {

void copy(const simulation::Items& items, ItemsSnapshot& to) {
    to.all.assign(items.all().begin(), items.all().end());
    to.present_count = items.present_count();
}

void copy_organisms(const simulation::Island& island, bool with_species, OrganismsSnapshot& to) {
    const physics::Circles& bodies = island.bodies();
    const auto copy = [&](const auto& from, auto& column) {
        column.assign(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(bodies.size()));
    };
    to.place_of.assign(island.bodies_by_id().begin(), island.bodies_by_id().end());
    copy(bodies.x, to.x);
    copy(bodies.y, to.y);
    copy(bodies.radius, to.radius_px);
    copy(island.living().health, to.health);
    if (island.living().has_brains()) {
        copy(island.living().heading, to.heading);
    } else {
        to.heading.clear(); // the memory may come from a snapshot of another world
    }
    to.species.resize(with_species ? to.place_of.size() : 0);
    for (std::size_t id = 0; id < to.species.size(); ++id) {
        to.species[id] = island.species_of(static_cast<std::uint32_t>(id));
    }
    to.alive_count = island.alive_count();
}

void copy(const simulation::Island& island, const parameters::Parameters& parameters, IslandSnapshot& to) {
    to.island = island.index();
    to.width_px = physics::to_px(island.area().width);
    to.height_px = physics::to_px(island.area().height);
    if (to.width_px <= 0 || to.height_px <= 0) { // an island without bodies has no walls
        to.width_px = parameters.island_width_px;
        to.height_px = parameters.island_height_px;
    }
    to.live = island.live_counts();
    copy_organisms(island, parameters.predator_count > 0, to.organisms);
    copy(island.food(), to.food);
    copy(island.poison(), to.poison);
    const physics::Boxes& boxes = island.boxes();
    to.boxes.x.assign(boxes.x.begin(), boxes.x.end());
    to.boxes.y.assign(boxes.y.begin(), boxes.y.end());
    to.boxes.half_width_px.assign(boxes.half_width.begin(), boxes.half_width.end());
    to.boxes.half_height_px.assign(boxes.half_height.begin(), boxes.half_height.end());
    to.crate_count = island.crate_count();
}

} // namespace

SnapshotPtr SnapshotPool::take(const simulation::Entry& entry, const std::vector<std::uint32_t>& islands,
                               bool after_change) {
    std::unique_ptr<Snapshot> taken;
    {
        const std::lock_guard lock{spare_->mutex};
        if (!spare_->snapshots.empty()) {
            taken = std::move(spare_->snapshots.back());
            spare_->snapshots.pop_back();
        }
    }
    if (!taken) {
        taken = std::make_unique<Snapshot>();
    }
    taken->world = entry.name;
    taken->run_id = entry.run_id;
    taken->moment = entry.world.moment();
    taken->state = entry.state();
    taken->speed = entry.control.speed;
    taken->hash = entry.world.hash();
    taken->ticks_per_s = entry.ticks_per_s;
    taken->slowed = entry.slowed;
    taken->item_radius_px = entry.world.parameters().active.item_radius_px;
    taken->island_count = entry.world.island_count();
    taken->after_change = after_change;
    entry.world.islands().bring(islands);
    taken->islands.resize(islands.size());
    for (std::size_t i = 0; i < islands.size(); ++i) {
        copy(entry.world.island(islands[i]), entry.world.parameters().active, taken->islands[i]);
    }

    return {taken.release(), [spare = spare_](const Snapshot* snapshot) {
                // The cast is allowed, because take() created the object as non-const.
                std::unique_ptr<Snapshot> back{const_cast<Snapshot*>(snapshot)};
                const std::lock_guard lock{spare->mutex};
                if (spare->snapshots.size() < spares_max) {
                    spare->snapshots.push_back(std::move(back));
                }
            }};
}

} // namespace evod::runtime
