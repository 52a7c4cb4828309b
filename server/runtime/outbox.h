// Outbox: passes data from other threads to the network thread: replies, events and the state of run files in order,
// and the newest snapshots.
//
// Threads      the simulation threads add data, the storage thread adds receipts, and background jobs add their
//              results. `wake` notifies the network thread, which then takes all data.
// Full         the mailbox and the sessions bound the number of replies. At most `events_max` events wait, of which
//              half may be of replays, and half of these of one user's replays; further ones are dropped and counted.
//              Of each world only the newest snapshot waits; replaced ones are counted. Changes of the state of run
//              files are rare and never dropped.
#pragma once

#include "server/base/quota.h"
#include "server/runtime/replies.h"
#include "server/runtime/snapshot.h"
#include "server/simulation/laboratory.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <variant>
#include <vector>

namespace evod::runtime {

constexpr std::size_t outbox_events_max = 4096;

/// A new state of the disk.
struct StorageChanged {
    simulation::Storage storage;
    std::string world = {}; // the only world that the state concerns; empty: all worlds
};

/// An event is for the sessions that are subscribed to it. A damaged world is one that has stopped now.
using Delivery = std::variant<Reply, v1::Event, StorageChanged, simulation::DamagedWorld>;

class Outbox {
  public:
    /// wake  called when the first entry is added to an empty outbox, on the thread that adds it. Must not block.
    explicit Outbox(std::function<void()> wake, std::size_t events_max = outbox_events_max)
        : wake_{std::move(wake)}, events_max_{events_max}, of_replays_{std::max<std::size_t>(events_max / 2, 1)} {}

    void reply(Reply reply) { add(std::move(reply)); }
    /// user  whose replay the event is about; empty: it is about a live world, or the server.
    void event(v1::Event event, const std::string& user = {});
    void storage(StorageChanged changed) { add(std::move(changed)); }
    void damaged(simulation::DamagedWorld world) { add(std::move(world)); }
    void snapshot(SnapshotPtr snapshot);

    struct NewestSnapshot {
        SnapshotPtr snapshot;
        std::uint64_t replaced_count = 0; // number of snapshots of the world that this one replaced in the outbox
        // true: this snapshot, or one that it replaced, shows the effect of a command or of a reached goal.
        bool after_change = false;
    };
    struct Taken {
        std::vector<Delivery> deliveries;
        // Number of events dropped since the last take(). Key: whose replays they are about; empty: all other events.
        std::map<std::string, std::uint64_t> dropped_events;
        std::vector<NewestSnapshot> snapshots; // at most one of each world
    };
    Taken take();

    struct FillLevel {
        std::size_t deliveries = 0, events = 0, events_max = 0; // `deliveries` includes the events
    };
    FillLevel fill() const;

  private:
    void add(Delivery delivery);
    void added(std::unique_lock<std::mutex> lock);

    const std::function<void()> wake_;
    const std::size_t events_max_;
    mutable std::mutex mutex_; // guards the members below
    Taken waiting_;
    std::size_t events_waiting_ = 0;
    base::Quota of_replays_; // the events of replays, by user
    bool woken_ = false;
};

} // namespace evod::runtime
