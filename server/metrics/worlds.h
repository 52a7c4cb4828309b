// Worlds: metrics of each world while it exists.
//
// Threads      the simulation thread adds worlds and counts; any thread calls list().
// Full         bounded by the number of worlds.
#pragma once

#include "server/metrics/counters.h"

#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace evod::metrics {

struct World {
    std::string name;
    TimeHistogram tick_time;     // per tick, with journal and snapshots; for ticks timed together, their mean
    TimeHistogram snapshot_time; // of the simulation thread, to copy a snapshot
    Gauge ticks_per_s;           // measured; 0 while the world does not run
};

class Worlds {
  public:
    /// Listed as long as the caller holds it.
    std::shared_ptr<World> add(std::string name);
    /// Sorted by name.
    std::vector<std::shared_ptr<const World>> list() const;

  private:
    mutable std::mutex mutex_; // guards the members below
    std::vector<std::weak_ptr<World>> worlds_;
};

} // namespace evod::metrics
