// Worlds: the metrics of each world that runs, and the names of the damaged worlds.
//
// Threads      the simulation thread adds worlds and updates the metrics. Any thread may call list().
// Full         never: it contains one entry per world, and the number of worlds is limited.
#pragma once

#include "server/metrics/counters.h"

#include <array>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace evod::metrics {

/// A species of a colony.
struct Species {
    Gauge living;    // at the end of the last generation, which with births is an interval
    Counter born;    // in the generations that have ended
    Counter counted; // generations in which the world had this species
};

struct World {
    std::string name;
    // Time per tick, including journal and snapshots; if several ticks are timed together, their mean.
    TimeHistogram tick_time;
    TimeHistogram snapshot_time;    // time for which the simulation thread copies a snapshot
    Gauge ticks_per_s;              // measured; 0 while the world does not run
    std::array<Species, 2> species; // the prey and the predators of a colony
};

class Worlds {
  public:
    /// Adds a world. list() contains the world as long as the caller keeps the result.
    std::shared_ptr<World> add(std::string name);
    /// Returns all worlds, sorted by name.
    std::vector<std::shared_ptr<const World>> list() const;

    /// Replaces the list of the damaged worlds, which do not run and have no metrics.
    void set_damaged(std::vector<std::string> names);
    /// The names of the damaged worlds, sorted.
    std::vector<std::string> damaged() const;

  private:
    mutable std::mutex mutex_; // guards the members below
    std::vector<std::weak_ptr<World>> worlds_;
    std::vector<std::string> damaged_;
};

} // namespace evod::metrics
