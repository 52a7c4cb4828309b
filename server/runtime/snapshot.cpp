#include "server/runtime/snapshot.h"

#include <utility>

namespace evod::runtime {
namespace {

void copy(const simulation::Items& items, ItemsSnapshot& to) {
    to.x.resize(items.size());
    to.y.resize(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        to.x[i] = items.all()[i].x;
        to.y[i] = items.all()[i].y;
    }
    to.due_tick.clear();
    if (items.present_count() == items.size())
        return;
    to.due_tick.resize(items.size());
    for (std::size_t i = 0; i < items.size(); ++i)
        to.due_tick[i] = items.all()[i].due_tick;
}

void copy_organisms(const simulation::Island& island, OrganismsSnapshot& to) {
    const std::size_t alive = island.alive_count();
    to.id.resize(alive);
    to.x.resize(alive);
    to.y.resize(alive);
    to.radius_px.resize(alive);
    to.health.resize(alive);
    const physics::Circles& bodies = island.bodies();
    std::size_t k = 0;
    const auto born = static_cast<std::uint32_t>(island.born().genes.cols());
    for (std::uint32_t id = 0; id < born; ++id) {
        const auto body = island.body_of(id);
        if (!body)
            continue;
        to.id[k] = id;
        to.x[k] = bodies.x[*body];
        to.y[k] = bodies.y[*body];
        to.radius_px[k] = bodies.radius[*body];
        to.health[k++] = island.living().health[*body];
    }
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
    copy_organisms(island, to.organisms);
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
    if (!taken)
        taken = std::make_unique<Snapshot>();
    taken->world = entry.name;
    taken->run_id = entry.run_id;
    taken->moment = entry.world.moment();
    taken->state = entry.state();
    taken->speed = entry.control.speed;
    taken->hash = entry.world.hash();
    taken->ticks_per_s = entry.ticks_per_s;
    taken->slowed = entry.slowed;
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
