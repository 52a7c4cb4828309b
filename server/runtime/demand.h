// Stream demand: the worlds and islands that sessions are subscribed to, and how often. A world without subscriptions costs
// nothing.
//
// Owner        the server.
// Threads      set by the network thread; read by the simulation thread when it has changed.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace evod::runtime {

/// What all subscriptions to one world need together.
struct WorldDemand {
    double rate_hz = 0; // the highest of their rates, > 0
    bool all_islands = false;
    std::vector<std::uint32_t> islands; // rising; meaningless with all_islands
    std::uint64_t newcomers = 0;        // rises when a subscription needs a snapshot at once
};

using WorldDemands = std::map<std::string, WorldDemand, std::less<>>; // by world

class StreamDemand {
  public:
    void set(WorldDemands worlds);

    bool changed() const { return changed_.load(std::memory_order_acquire); }
    WorldDemands take();

    /// Whether any session is subscribed to events.
    void want_events(bool wanted) { events_wanted_.store(wanted, std::memory_order_relaxed); }
    bool events_wanted() const { return events_wanted_.load(std::memory_order_relaxed); }

  private:
    std::atomic<bool> changed_ = false, events_wanted_ = false;
    std::mutex mutex_; // guards what follows
    WorldDemands worlds_;
};

} // namespace evod::runtime
