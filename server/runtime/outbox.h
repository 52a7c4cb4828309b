// Outbox: what the simulation thread hands to the network thread: answers and events in order, and the newest pictures.
//
// Threads      filled by the simulation thread, taken by the network thread, which `wake` calls for.
// Full         answers are at most as many as the mailbox and the sessions let in, and news of the disk a few a second.
//              Of events `events_max` wait; more are dropped and counted. Of each world the newest picture waits; the
//              ones it replaced are counted.
#pragma once

#include "server/runtime/snapshot.h"

#include <cstdint>
#include <functional>
#include <mutex>
#include <vector>

namespace evod::runtime {

constexpr std::size_t outbox_events_max = 4096;

/// Run on the network thread.
using Delivery = std::function<void()>;

class Outbox {
  public:
    /// wake  called on the simulation thread when the outbox is no longer empty; must not block.
    explicit Outbox(std::function<void()> wake, std::size_t events_max = outbox_events_max)
        : wake_{std::move(wake)}, events_max_{events_max} {}

    void answer(Delivery delivery);
    void event(Delivery delivery);
    void picture(SnapshotPtr snapshot);

    struct Picture {
        SnapshotPtr snapshot;
        std::uint64_t replaced_count = 0; // pictures of the world that this one replaced here
        bool after_change = false;        // one of them, or this, showed a change by command or goal
    };
    struct Taken {
        std::vector<Delivery> deliveries;
        std::uint64_t dropped_events = 0; // since the last time
        std::vector<Picture> pictures;    // at most one of a world
    };
    Taken take();

    struct Fill {
        std::size_t deliveries = 0, events = 0, events_max = 0; // events are among the deliveries
    };
    Fill fill() const;

  private:
    void added(std::unique_lock<std::mutex> lock);

    const std::function<void()> wake_;
    const std::size_t events_max_;
    mutable std::mutex mutex_; // guards what follows
    Taken waiting_;
    std::size_t events_waiting_ = 0;
    bool woken_ = false;
};

} // namespace evod::runtime
