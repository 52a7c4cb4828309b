// Stream demand: the worlds and islands to which sessions are subscribed, and their snapshot rates. A world without
// subscriptions causes no work.
//
// Owner        the server.
// Threads      the network thread sets it. The simulation thread reads it after a change.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace evod::runtime {

/// The combined demand of all subscriptions to one world.
struct WorldDemand {
    double rate_hz = 0; // the highest rate of these subscriptions, > 0
    bool all_islands = false;
    std::vector<std::uint32_t> islands; // indices in rising order; ignored if all_islands is set
    std::uint64_t newcomers = 0;        // incremented when a subscription needs a snapshot immediately
};

using WorldDemands = std::map<std::string, WorldDemand, std::less<>>; // key: name of the world

class StreamDemand {
  public:
    void set(WorldDemands worlds);

    bool changed() const { return changed_.load(std::memory_order_acquire); }
    WorldDemands take();

    /// Sets whether any session is subscribed to events.
    void want_events(bool wanted) { events_wanted_.store(wanted, std::memory_order_relaxed); }
    bool events_wanted() const { return events_wanted_.load(std::memory_order_relaxed); }

  private:
    std::atomic<bool> changed_ = false, events_wanted_ = false;
    std::mutex mutex_; // guards the members below
    WorldDemands worlds_;
};

} // namespace evod::runtime
