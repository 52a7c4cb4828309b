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
#include <utility>
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
    Clock::time_point now() { return clock_.now(); }
    /// Removes a subscription, with its snapshots that wait.
    void unsubscribe(std::uint32_t subscription_id);
    /// Drops the record of the islands from index `first` on.
    void forget_islands(SnapshotSubscription& subscription, std::uint32_t first);

    /// The largest frame body that the client accepts; larger frames are dropped.
    void set_frame_bytes_max(std::size_t bytes) { frame_bytes_max_ = bytes; }

    /// Replaces the waiting snapshot of an island. The caller must call send_snapshots() afterwards.
    void offer(std::uint32_t subscription_id, std::uint32_t island, StreamedSnapshotPtr snapshot);
    /// Makes the next snapshot of an island a keyframe. Sends the waiting snapshot or, if none waits, `newest`. Returns
    /// false, and changes nothing, if a keyframe waits already.
    ///
    /// at  the keyframe is sent at this time or later
    bool send_keyframe(std::uint32_t subscription_id, std::uint32_t island, StreamedSnapshotPtr newest,
                       Clock::time_point at = {});
    /// Sends a snapshot again after the view has changed: the waiting one or, if none waits, `newest`.
    void send_again(std::uint32_t subscription_id, std::uint32_t island, StreamedSnapshotPtr newest,
                    Clock::time_point at = {});
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

    /// The memory of the queue and its subscriptions, without the snapshots, which sessions share. It costs little.
    std::size_t held_bytes() const;

    /// Makes the queue accept no more snapshots.
    void stop() { stopped_ = true; }
    /// Drops all waiting snapshots and accepts no more.
    void clear();

  private:
    using Island = SnapshotSubscription::Island;
    /// Puts the waiting snapshot of an island at the end of the queue. It must have no turn.
    void line_up(std::uint32_t subscription_id, std::uint32_t index, Island& island);
    /// Replaces the delay of a waiting snapshot. If it has no turn, or its turn was postponed, puts it at the end of
    /// the queue; otherwise it keeps its turn.
    void delay_until(Clock::time_point at, std::uint32_t subscription_id, std::uint32_t index, Island& island);
    /// Notes that a snapshot was sent, which must be acknowledged.
    void await_acknowledgement(Island& island, std::uint64_t sequence);
    /// Encodes a snapshot into outgoing_. Returns false if the bandwidth limit does not allow it yet.
    bool take(std::uint32_t subscription_id, SnapshotSubscription& subscription, Island& island);
    /// Drops the snapshot in outgoing_ because it is larger than the client accepts.
    void drop_outgoing(SnapshotSubscription& subscription, Island& island);
    void set_tail(std::uint32_t subscription_id, std::uint64_t dropped_count);

    Clock& clock_;
    metrics::Counter& dropped_;
    SnapshotSender& sender_;
    std::size_t frame_bytes_max_ = std::numeric_limits<std::size_t>::max();
    // A turn is the place of a waiting snapshot in the sending order. An island has at most one. It has none while it
    // waits for an acknowledgement. While it is delayed, its turn is in postponed_.
    struct Turn {
        std::uint32_t subscription_id, island;
        std::uint64_t number; // invalid if it differs from SnapshotSubscription::Island::turn
    };
    std::deque<Turn> turns_;
    // The key is Island::not_before and the number of the turn.
    std::map<std::pair<Clock::time_point, std::uint64_t>, Turn> postponed_;
    std::uint64_t last_turn_ = 0;
    std::size_t unacknowledged_bytes_ = 0; // memory of all Island::unacknowledged
    OutgoingFrame outgoing_;
    Clock::time_point retry_at_ = Clock::time_point::max();
    bool stopped_ = false;
};

} // namespace evod::streaming
