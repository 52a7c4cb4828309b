// Streams: manages the subscriptions of all sessions, and passes snapshots and events from the simulation to them.
//
// Owner        the server.
// Threads      the network thread.
#pragma once

#include "server/network/session.h"
#include "server/runtime/outbox.h"
#include "server/runtime/simulations.h"
#include "server/streaming/snapshot_streams.h"

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace evod::network {

class Streams {
  public:
    /// All arguments must outlive this object.
    Streams(const Sessions& sessions, runtime::Simulations& simulations, SendMemory& memory)
        : sessions_{sessions}, simulations_{simulations}, snapshots_{&memory} {}

    /// Returns the id of the new subscription. For the rate limit of the session, each island counts as a frame.
    std::uint32_t subscribe(Session& session, streaming::SnapshotSubscription subscription);
    std::uint32_t subscribe(Session& session, EventSubscription subscription);
    /// Ends a subscription. Returns false if the session has no such subscription.
    bool unsubscribe(Session& session, std::uint32_t subscription_id);
    /// Sends the newest snapshots of a subscription as keyframes. Returns false if the session has no such
    /// subscription. For the rate limit of the session, each snapshot counts as a frame.
    bool send_keyframes(Session& session, std::uint32_t subscription_id);
    /// Changes the view of a subscription that has one. The newest snapshots are sent again with the new view, and
    /// count in the same way.
    void set_view(Session& session, std::uint32_t subscription_id, const v1::View& view);

    /// Returns, by session, its part of the memory of the snapshots that sessions share.
    std::map<std::uint64_t, std::size_t> shared_bytes() const { return snapshots_.shared_bytes(); }

    /// Must be called after a session was removed from the table.
    void forget(const Session& session);
    /// Must be called when a world was deleted. Its snapshots and events are no longer sent.
    void forget_world(const std::string& world);

    /// Returns a function for the simulation threads. It puts events into the outbox if any session is subscribed to
    /// events.
    decltype(runtime::LoopOutputs::events) outlet(runtime::Outbox& outbox);
    /// Stores the snapshots for send_some(), and counts dropped events.
    void deliver(runtime::Outbox::Taken taken);
    /// Distributes the next islands of snapshots to the sessions. Returns true if islands remain for another call.
    bool send_some(runtime::Clock::time_point now) { return snapshots_.distribute(now); }
    /// Sends an event to the sessions that are subscribed to it.
    void publish(v1::Event event);
    /// Sends all sessions the event that the server is shutting down.
    void announce_end();
    /// Ends all sessions after their queued data was sent.
    void end_sessions();

  private:
    void update_demand();

    const Sessions& sessions_;
    runtime::Simulations& simulations_;
    streaming::SnapshotStreams snapshots_;
};

} // namespace evod::network
