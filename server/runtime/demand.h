// Demand: who is watched, and how closely. Nobody watched costs nothing.
//
// Threads      set by the network thread, read by the simulation thread when it has changed.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace evod::runtime {

/// What all subscriptions to one world want together.
struct Watch {
    double rate_hz = 0; // the highest that somebody wants, > 0
    bool all_islands = false;
    std::vector<std::uint32_t> islands; // rising; without meaning for all_islands
    std::uint64_t newcomers = 0;        // rises when somebody new watches: a picture is wanted now
};

using Watches = std::map<std::string, Watch, std::less<>>; // by world

class Demand {
  public:
    void set(Watches watches);

    bool changed() const { return changed_.load(std::memory_order_acquire); }
    Watches take();

    /// Whether anybody wants events at all.
    void want_events(bool wanted) { events_wanted_.store(wanted, std::memory_order_relaxed); }
    bool events_wanted() const { return events_wanted_.load(std::memory_order_relaxed); }

  private:
    std::atomic<bool> changed_ = false, events_wanted_ = false;
    std::mutex mutex_; // guards what follows
    Watches watches_;
};

} // namespace evod::runtime
