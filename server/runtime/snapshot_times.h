// Snapshot times: when the viewers of a world must get its next snapshot, and of which islands.
//
// Owner        a simulation loop, one per world.
#pragma once

#include "server/runtime/clock.h"
#include "server/runtime/demand.h"
#include "server/simulation/world.h"

#include <cstdint>
#include <vector>

namespace evod::runtime {

class SnapshotTimes {
  public:
    /// demand  must outlive this object, or its next call; nullptr: the world has no viewers.
    void set_demand(const WorldDemand* demand) { demand_ = demand; }
    /// Makes a snapshot due, because a command or a reached goal has changed the world.
    void show_change() { changed_ = true; }
    bool shows_change() const { return changed_; }

    bool is_due(const simulation::World& world, Clock::time_point now) const;
    /// Returns the indices of the islands that viewers want. There must be a demand. Valid until the next call.
    const std::vector<std::uint32_t>& wanted_islands(const simulation::World& world);
    /// Plans the next snapshot, after one was taken.
    void taken(const simulation::World& world, Clock::time_point now);

  private:
    Clock::duration between() const;

    const WorldDemand* demand_ = nullptr;
    std::uint64_t newcomers_served_ = 0;
    bool changed_ = true; // since the last snapshot
    std::uint64_t shown_tick_ = 0;
    Clock::time_point next_;
    std::vector<std::uint32_t> islands_; // reused buffer
};

} // namespace evod::runtime
