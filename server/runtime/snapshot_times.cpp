#include "server/runtime/snapshot_times.h"

#include <numeric>

namespace evod::runtime {

Clock::duration SnapshotTimes::between() const {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>{1 / demand_->rate_hz});
}

bool SnapshotTimes::is_due(const simulation::World& world, Clock::time_point now) const {
    if (demand_ == nullptr) {
        return false;
    }
    if (changed_ || newcomers_served_ != demand_->newcomers) {
        return true;
    }
    // A snapshot may be taken early by 10 % of the interval. Ticks rarely coincide with the planned time, and waiting
    // for the next tick could delay the snapshot by a whole tick.
    return world.moment().tick != shown_tick_ && now + between() / 10 >= next_;
}

const std::vector<std::uint32_t>& SnapshotTimes::wanted_islands(const simulation::World& world) {
    islands_.clear();
    if (demand_->all_islands) {
        islands_.resize(world.island_count());
        std::iota(islands_.begin(), islands_.end(), 0u);
        return islands_;
    }
    for (const std::uint32_t island : demand_->islands) {
        if (island < world.island_count()) {
            islands_.push_back(island);
        }
    }
    return islands_;
}

void SnapshotTimes::taken(const simulation::World& world, Clock::time_point now) {
    // Snapshots follow a fixed time grid, so that the average rate is exact. A pause or an extra snapshot restarts the
    // grid.
    next_ += between();
    if (changed_ || newcomers_served_ != demand_->newcomers || next_ <= now) {
        next_ = now + between();
    }
    newcomers_served_ = demand_->newcomers;
    changed_ = false;
    shown_tick_ = world.moment().tick;
}

} // namespace evod::runtime
