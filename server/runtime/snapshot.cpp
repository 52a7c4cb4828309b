#include "server/runtime/snapshot.h"

#include <utility>

namespace evod::runtime {
namespace {

void copy(const simulation::Items& items, ItemsSnapshot& to) {
    to.x = items.x();
    to.y = items.y();
    if (items.present_count() == items.size())
        to.due_tick.clear();
    else
        to.due_tick = items.due_tick();
}

void copy(const simulation::Island& island, const simulation::Parameters& parameters, IslandSnapshot& to) {
    to.island = island.index();
    to.width_px = physics::to_px(island.area().width);
    to.height_px = physics::to_px(island.area().height);
    if (to.width_px <= 0 || to.height_px <= 0) { // an island without bodies has no walls either
        to.width_px = parameters.island_width_px;
        to.height_px = parameters.island_height_px;
    }
    to.live = island.live_statistics();
    const physics::Circles& bodies = island.bodies();
    to.organisms.id = bodies.id;
    to.organisms.x = bodies.x;
    to.organisms.y = bodies.y;
    to.organisms.radius_px = bodies.radius;
    to.organisms.health = island.living().health;
    copy(island.food(), to.food);
    copy(island.poison(), to.poison);
    const physics::Boxes& boxes = island.boxes();
    to.boxes.x = boxes.x;
    to.boxes.y = boxes.y;
    to.boxes.half_width_px = boxes.half_width;
    to.boxes.half_height_px = boxes.half_height;
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
    if (!taken)
        taken = std::make_unique<Snapshot>();
    taken->world = entry.name;
    taken->run_id = entry.run_id;
    taken->moment = entry.world.moment();
    taken->state = entry.state();
    taken->speed = entry.control.speed;
    taken->hash = entry.world.hash();
    taken->ticks_per_s = entry.ticks_per_s;
    taken->item_radius_px = entry.world.parameters().active.item_radius_px;
    taken->island_count = static_cast<std::uint32_t>(entry.world.islands().size());
    taken->after_change = after_change;
    taken->islands.resize(islands.size());
    for (std::size_t i = 0; i < islands.size(); ++i)
        copy(entry.world.islands()[islands[i]], entry.world.parameters().active, taken->islands[i]);

    return {taken.release(), [spare = spare_](const Snapshot* snapshot) {
                std::unique_ptr<Snapshot> back{const_cast<Snapshot*>(snapshot)}; // made above, and not const there
                const std::lock_guard lock{spare->mutex};
                if (spare->snapshots.size() < spares_max)
                    spare->snapshots.push_back(std::move(back));
            }};
}

} // namespace evod::runtime
