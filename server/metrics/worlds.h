// Worlds: what is counted of each while it is there.
//
// Threads      worlds come and go on the simulation thread, which counts; list() is for any.
// Full         as many as there are worlds.
#pragma once

#include "server/metrics/counters.h"

#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace evod::metrics {

struct World {
    std::string name;
    TimeHistogram tick_time;    // with what was written down and shown of the tick; the mean of those timed together
    TimeHistogram picture_time; // that the simulation took to give a picture away
    Gauge ticks_per_s;          // measured; 0 while it stands
};

class Worlds {
  public:
    /// It is listed as long as somebody holds it besides this.
    std::shared_ptr<World> add(std::string name);
    /// By name.
    std::vector<std::shared_ptr<const World>> list() const;

  private:
    mutable std::mutex mutex_; // guards what follows
    std::vector<std::weak_ptr<World>> worlds_;
};

} // namespace evod::metrics
