// Snapshot queue: the snapshots that wait to be sent to one session, and the order in which they are sent.
//
// Of each subscription and island at most one snapshot waits, the newest. It is encoded when its turn comes, against the
// snapshot that the session was sent last. It waits longer while too many earlier ones are unacknowledged or the
// bandwidth limit does not allow it.
//
// Owner        the session, which does the sending.
// Threads      the network thread.
// Full         a newer snapshot replaces the waiting one; the subscription counts it as dropped.
#pragma once

#include "evod/v1/session.pb.h"
#include "server/metrics/counters.h"
#include "server/runtime/clock.h"
#include "server/streaming/subscription.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <string_view>
#include <vector>

namespace evod::streaming {

/// The session that sends what waits in a queue.
class SnapshotSender {
  public:
    /// Sends what may be sent now, without waiting for the connection.
    virtual void send_snapshots() = 0;
    /// Sends it after answers that are queued already.
    virtual void send_snapshots_later() = 0;

  protected:
    virtual ~SnapshotSender() = default;
};

/// The body of a frame, in parts.
struct OutgoingFrame {
    StreamedSnapshotPtr snapshot;          // owns the parts
    std::vector<const SharedBytes*> parts; // fields 1 to 49
    std::array<std::uint8_t, 24> tail;     // begins with the fields from 50 on
    std::size_t tail_bytes = 0;

    std::size_t body_bytes() const;
    std::string_view tail_view() const { return {reinterpret_cast<const char*>(tail.data()), tail_bytes}; }
};

class SnapshotQueue {
  public:
    using Clock = runtime::Clock;

    /// dropped  counts the snapshots that were replaced before they were sent.
    SnapshotQueue(Clock& clock, metrics::Counter& dropped, SnapshotSender& sender)
        : clock_{clock}, dropped_{dropped}, sender_{sender} {}

    std::map<std::uint32_t, SnapshotSubscription> subscriptions; // by subscription id
    SnapshotSender& sender() { return sender_; }

    /// The largest frame body that the client accepts; larger frames are dropped.
    void set_frame_bytes_max(std::size_t bytes) { frame_bytes_max_ = bytes; }

    /// Replaces the waiting snapshot of an island. The caller calls send_snapshots() afterwards.
    void offer(std::uint32_t subscription_id, std::uint32_t island, StreamedSnapshotPtr snapshot);
    /// Sends the next snapshot of an island as a keyframe: the waiting one, or else `newest`.
    void send_keyframe(std::uint32_t subscription_id, std::uint32_t island, StreamedSnapshotPtr newest);
    /// The view has changed: sends the waiting snapshot again, or else `newest`.
    void send_again(std::uint32_t subscription_id, std::uint32_t island, StreamedSnapshotPtr newest);
    void acknowledge(const v1::AcknowledgeSnapshot& acknowledged);
    /// Counts snapshots of a subscription that newer ones replaced.
    void count_dropped(SnapshotSubscription& of, std::uint64_t count);

    /// Chooses and encodes the snapshot whose turn it is. null: none may be sent now. Valid until the next call; it counts
    /// as sent.
    const OutgoingFrame* next();
    /// When next() may succeed again because of a bandwidth limit; max(): not before another event.
    Clock::time_point retry_at() const { return retry_at_; }
    /// Releases the snapshot returned last: its memory is in no accounting.
    void release() { outgoing_.snapshot = {}; }

    /// Accepts no more snapshots.
    void stop() { stopped_ = true; }
    /// Drops everything that waits, and stops.
    void clear();

  private:
    using Island = SnapshotSubscription::Island;
    /// Queues the waiting snapshot of an island behind the others.
    void give_turn(std::uint32_t subscription_id, std::uint32_t index, Island& island);
    /// Encodes a snapshot into outgoing_. false: the bandwidth limit does not allow it yet.
    bool take(std::uint32_t subscription_id, SnapshotSubscription& subscription, Island& island);
    /// Drops the snapshot in outgoing_, which is larger than the client accepts.
    void drop_outgoing(SnapshotSubscription& subscription, Island& island);
    void set_tail(std::uint32_t subscription_id, std::uint64_t dropped_count);

    Clock& clock_;
    metrics::Counter& dropped_;
    SnapshotSender& sender_;
    std::size_t frame_bytes_max_ = std::numeric_limits<std::size_t>::max();
    // A waiting snapshot has one valid turn, the last it was given: none while it waits for an acknowledgement, and one in
    // postponed_ while the bandwidth limit delays it.
    struct Turn {
        std::uint32_t subscription_id, island;
        std::uint64_t number; // invalid if it differs from SnapshotSubscription::Island::turn
    };
    std::deque<Turn> turns_;
    std::multimap<Clock::time_point, Turn> postponed_;
    std::uint64_t last_turn_ = 0;
    OutgoingFrame outgoing_;
    Clock::time_point retry_at_ = Clock::time_point::max();
    bool stopped_ = false;
};

} // namespace evod::streaming
