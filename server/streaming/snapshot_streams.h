// Snapshot streams: which sessions are subscribed to which worlds, and the path of a snapshot from the simulation to
// their queues.
//
// Subscriptions to one world at one rate and in one form are a group. A group has one pace, so all of its viewers receive
// the same snapshots, and each snapshot is encoded once per island for all of them.
//
// A world of thousands of islands takes the network thread a tenth of a second. Its islands are therefore distributed in
// several turns. Between the turns the thread serves other clients and other worlds.
//
// Owner        network::Streams.
// Threads      the network thread.
#pragma once

#include "proto/codec/compression.h"
#include "server/runtime/demand.h"
#include "server/runtime/outbox.h"
#include "server/streaming/snapshot_queue.h"

#include <compare>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace evod::streaming {

class SnapshotStreams {
  public:
    /// Adds a subscription to a session's queue. The newest snapshots of its group, if there are any, are sent at once.
    ///
    /// session  number of the session, the same for all calls with this queue.
    void subscribe(std::uint64_t session, SnapshotQueue& queue, std::uint32_t subscription_id,
                   SnapshotSubscription subscription);
    /// false: the queue has no such subscription.
    bool unsubscribe(std::uint64_t session, SnapshotQueue& queue, std::uint32_t subscription_id);
    /// The session has ended; its queue is not used again.
    void forget(std::uint64_t session);

    /// Sends the newest snapshots of a subscription as keyframes. false: the queue has no such subscription.
    bool send_keyframes(SnapshotQueue& queue, std::uint32_t subscription_id);
    /// Changes the view of a subscription that has one, and sends the newest snapshots again.
    void set_view(SnapshotQueue& queue, std::uint32_t subscription_id, const v1::View& view);

    /// The world has been deleted: drops everything of it.
    void forget_world(const std::string& world);

    /// What the simulation thread should copy.
    runtime::WorldDemands demand() const;

    /// Accepts snapshots for distribute(). Of each world a newer snapshot replaces one that waits here.
    void deliver(std::vector<runtime::Outbox::NewestSnapshot> snapshots);
    /// Distributes the next islands to the queues and has them sent. true: more islands are left for another call.
    bool distribute(runtime::Clock::time_point now);

  private:
    struct GroupName {
        std::string world;
        double rate_hz;
        Form form;
        friend auto operator<=>(const GroupName&, const GroupName&) = default;
    };
    struct Group {
        std::size_t subscription_count = 0;
        runtime::Clock::time_point next_snapshot;            // not before then
        std::map<std::uint32_t, StreamedSnapshotPtr> newest; // by island
        simulation::RunId run_id;                            // of these
    };
    /// A snapshot whose islands are being distributed.
    struct InProgress {
        runtime::Outbox::NewestSnapshot snapshot;
        bool begun = false;
        runtime::Clock::time_point began = {};
        std::size_t next_island = 0;                       // in the snapshot
        std::set<GroupName> groups = {};                   // that receive it
        std::optional<runtime::Outbox::NewestSnapshot> next = {}; // a newer snapshot of the same world
    };
    struct Viewer {
        SnapshotQueue* queue;
        std::uint32_t subscription_id;
        const SnapshotSubscription* subscription;
        Group* group;
        bool has_new = false;
    };

    static GroupName group_of(const SnapshotSubscription& subscription);
    void leave_group(const SnapshotSubscription& subscription);
    /// Chooses the groups that receive a snapshot.
    void begin(InProgress& of, runtime::Clock::time_point now);
    std::vector<Viewer> viewers_of(const InProgress& of);
    /// Distributes islands until all are done or no step is left. An island takes one step, and one for each viewer.
    void advance(InProgress& of, std::size_t& steps_left);
    /// Calls what(island, snapshot) for each island of the subscription.
    template <class Do>
    void each_newest(const SnapshotSubscription& subscription, const Do& what) const;

    std::map<std::uint64_t, SnapshotQueue*> queues_; // of sessions that have subscribed, by number
    std::uint64_t newcomers_ = 0, sequence_ = 0;
    codec::Compressor compressor_;
    std::map<GroupName, Group> groups_;  // those with subscriptions
    std::deque<InProgress> in_progress_; // at most one of a world
};

} // namespace evod::streaming
