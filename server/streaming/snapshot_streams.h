// Snapshot streams: stores which sessions are subscribed to which worlds, and passes snapshots from the simulation to
// the queues of these sessions.
//
// All subscriptions to the same world with the same rate and the same form are a group. All viewers of a group receive
// the same snapshots, so each snapshot is encoded once per island for the whole group.
//
// To distribute a snapshot of thousands of islands, the network thread needs about a tenth of a second. It therefore
// distributes the islands in several steps. Between the steps it serves other clients and other worlds.
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
    /// memory  counts the memory of all snapshots; must outlive them. nullptr: they are not counted.
    explicit SnapshotStreams(SnapshotMemory* memory = nullptr) : memory_{memory} {}

    /// Adds a subscription to the queue of a session. If its group already has snapshots, the newest ones are sent at
    /// once.
    ///
    /// session  number of the session. All calls with the same queue must use the same number.
    void subscribe(std::uint64_t session, SnapshotQueue& queue, std::uint32_t subscription_id,
                   SnapshotSubscription subscription);
    /// Ends a subscription. Returns false if the queue has no such subscription.
    bool unsubscribe(std::uint64_t session, SnapshotQueue& queue, std::uint32_t subscription_id);
    /// Must be called when a session has ended. Its queue is not used afterwards.
    void forget(std::uint64_t session);

    /// Sends the newest snapshots of a subscription as keyframes, except those of islands of which a keyframe waits
    /// already. They wait if the subscription has sent such keyframes within the interval between its snapshots.
    /// Returns their number, with the exceptions; nullopt: the queue has no such subscription.
    std::optional<std::size_t> send_keyframes(SnapshotQueue& queue, std::uint32_t subscription_id);
    /// Changes the view of a subscription that has one, and sends the newest snapshots again. Returns their number.
    std::size_t set_view(SnapshotQueue& queue, std::uint32_t subscription_id, const v1::View& view);

    /// Returns, by session, its part of the memory of the snapshots that sessions share. It walks the snapshots of all
    /// groups.
    std::map<std::uint64_t, std::size_t> shared_bytes() const;

    /// Must be called when a world was deleted. Drops all snapshots of the world.
    void forget_world(const std::string& world);

    /// The worlds and islands that the simulation thread should copy.
    runtime::WorldDemands demand() const;

    /// Stores snapshots for distribute(). A newer snapshot of a world replaces the one that is stored here.
    void deliver(std::vector<runtime::Outbox::NewestSnapshot> snapshots);
    /// Passes the next islands to the queues and makes the sessions send them. Returns true if islands remain for
    /// another call.
    bool distribute(runtime::Clock::time_point now);

  private:
    struct GroupName {
        std::string world;
        double rate_hz;
        Form form;
        OptionalColumns with;
        friend auto operator<=>(const GroupName&, const GroupName&) = default;
    };
    struct Group {
        std::size_t subscription_count = 0;
        runtime::Clock::time_point next_snapshot;            // earliest time of the next snapshot
        std::map<std::uint32_t, StreamedSnapshotPtr> newest; // key: island
        simulation::RunId run_id;                            // run of these snapshots
    };
    /// A snapshot whose islands are currently being distributed.
    struct InProgress {
        runtime::Outbox::NewestSnapshot snapshot;
        bool begun = false;
        runtime::Clock::time_point began = {};
        std::size_t next_island = 0;     // index in the snapshot
        std::set<GroupName> groups = {}; // groups that receive this snapshot
        // The newest snapshot of the same world. It is distributed after `snapshot`.
        std::optional<runtime::Outbox::NewestSnapshot> next = {};
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
    /// Chooses the groups that receive the snapshot.
    void begin(InProgress& of, runtime::Clock::time_point now);
    std::vector<Viewer> viewers_of(const InProgress& of);
    /// Distributes islands until all are done or no step is left. Each island costs one step, plus one per viewer.
    void advance(InProgress& of, std::size_t& steps_left);
    /// Calls what(island, snapshot) for the newest snapshot of each island that the subscription includes.
    template <class Do>
    void each_newest(const SnapshotSubscription& subscription, const Do& what) const;

    SnapshotMemory* memory_;
    // Queues of the sessions that have subscriptions; key: number of the session.
    std::map<std::uint64_t, SnapshotQueue*> queues_;
    std::uint64_t newcomers_ = 0, sequence_ = 0; // the last SnapshotSubscription::newcomer, and the last sequence
    codec::Compressor compressor_;
    std::map<GroupName, Group> groups_;  // groups that have subscriptions
    std::deque<InProgress> in_progress_; // at most one snapshot of each world
};

} // namespace evod::streaming
