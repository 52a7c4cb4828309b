// Snapshot queue: the snapshots that wait to be sent to one session, and their order.
//
// At most one snapshot waits for each subscription and island: the newest. It is encoded when its turn comes, against
// the last snapshot that was sent to the session. It waits longer if too many earlier snapshots are unacknowledged, or
// if the bandwidth limit does not allow it.
//
// Owner        the session, which sends the snapshots.
// Threads      the network thread.
// Full         a newer snapshot replaces the waiting snapshot, which the subscription counts as dropped.
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

/// The interface of a session through which its queue makes it send snapshots.
class SnapshotSender {
  public:
    /// Sends the snapshots that may be sent now and that the connection accepts without waiting.
    virtual void send_snapshots() = 0;
    /// Sends the snapshots after the answers that are already queued.
    virtual void send_snapshots_later() = 0;

  protected:
    virtual ~SnapshotSender() = default;
};

/// The body of a frame, divided into parts.
struct OutgoingFrame {
    StreamedSnapshotPtr snapshot;          // keeps the parts alive
    std::vector<const SharedBytes*> parts; // together they are the fields 1 to 49
    std::array<std::uint8_t, 24> tail;     // fields from 50 on, tail_bytes bytes long
    std::size_t tail_bytes = 0;

    std::size_t body_bytes() const;
    std::string_view tail_view() const { return {reinterpret_cast<const char*>(tail.data()), tail_bytes}; }
};

class SnapshotQueue {
  public:
    using Clock = runtime::Clock;

    /// dropped  counts snapshots that were replaced before they were sent.
    SnapshotQueue(Clock& clock, metrics::Counter& dropped, SnapshotSender& sender)
        : clock_{clock}, dropped_{dropped}, sender_{sender} {}

    std::map<std::uint32_t, SnapshotSubscription> subscriptions; // key: subscription id
    SnapshotSender& sender() { return sender_; }

    /// The largest frame body that the client accepts; larger frames are dropped.
    void set_frame_bytes_max(std::size_t bytes) { frame_bytes_max_ = bytes; }

    /// Replaces the waiting snapshot of an island. The caller must call send_snapshots() afterwards.
    void offer(std::uint32_t subscription_id, std::uint32_t island, StreamedSnapshotPtr snapshot);
    /// Makes the next snapshot of an island a keyframe. Sends the waiting snapshot or, if none waits, `newest`.
    void send_keyframe(std::uint32_t subscription_id, std::uint32_t island, StreamedSnapshotPtr newest);
    /// Sends a snapshot again after the view has changed: the waiting one or, if none waits, `newest`.
    void send_again(std::uint32_t subscription_id, std::uint32_t island, StreamedSnapshotPtr newest);
    void acknowledge(const v1::AcknowledgeSnapshot& acknowledged);
    /// Counts snapshots of a subscription that were replaced by newer ones.
    void count_dropped(SnapshotSubscription& of, std::uint64_t count);

    /// Chooses and encodes the next snapshot, which then counts as sent. Returns nullptr if none may be sent now. The
    /// result is valid until the next call.
    const OutgoingFrame* next();
    /// The earliest time at which the bandwidth limit may allow another snapshot; max(): it delays no snapshot.
    Clock::time_point retry_at() const { return retry_at_; }
    /// Releases the last snapshot that next() returned, because its memory is not counted by SendMemory.
    void release() { outgoing_.snapshot = {}; }

    /// Makes the queue accept no more snapshots.
    void stop() { stopped_ = true; }
    /// Drops all waiting snapshots and accepts no more.
    void clear();

  private:
    using Island = SnapshotSubscription::Island;
    /// Moves the waiting snapshot of an island to the end of the queue.
    void move_to_end(std::uint32_t subscription_id, std::uint32_t index, Island& island);
    /// Encodes a snapshot into outgoing_. Returns false if the bandwidth limit does not allow it yet.
    bool take(std::uint32_t subscription_id, SnapshotSubscription& subscription, Island& island);
    /// Drops the snapshot in outgoing_ because it is larger than the client accepts.
    void drop_outgoing(SnapshotSubscription& subscription, Island& island);
    void set_tail(std::uint32_t subscription_id, std::uint64_t dropped_count);

    Clock& clock_;
    metrics::Counter& dropped_;
    SnapshotSender& sender_;
    std::size_t frame_bytes_max_ = std::numeric_limits<std::size_t>::max();
    // A turn is the place of a waiting snapshot in the sending order. Only the newest turn of a snapshot is valid. A
    // snapshot has no turn while it waits for an acknowledgement. While the bandwidth limit delays it, its turn is in
    // postponed_.
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
