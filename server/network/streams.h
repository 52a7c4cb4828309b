// Streams: the subscriptions of all sessions, and the path of snapshots and events from the simulation to them.
//
// Owner        the server.
// Threads      the network thread.
#pragma once

#include "server/network/session.h"
#include "server/runtime/demand.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/outbox.h"
#include "server/streaming/snapshot_streams.h"

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace evod::network {

/// By session number.
using Sessions = std::map<std::uint64_t, SessionPtr>;

class Streams {
  public:
    /// The arguments must outlive the streams.
    Streams(const Sessions& sessions, runtime::StreamDemand& demand, runtime::Mailbox& mailbox)
        : sessions_{sessions}, demand_{demand}, mailbox_{mailbox} {}

    /// Returns the id of the new subscription.
    std::uint32_t subscribe(Session& session, streaming::SnapshotSubscription subscription);
    std::uint32_t subscribe(Session& session, EventSubscription subscription);
    /// false: the session has no such subscription.
    bool unsubscribe(Session& session, std::uint32_t subscription_id);
    /// Sends the newest snapshots of a subscription as keyframes. false: the session has no such subscription.
    bool send_keyframes(Session& session, std::uint32_t subscription_id);
    /// Changes the view of a subscription that has one, for the newest snapshots and those that follow.
    void set_view(Session& session, std::uint32_t subscription_id, const v1::View& view);

    /// The session has been removed from the table.
    void forget(const Session& session);
    /// The world has been deleted: nothing more of it is sent.
    void forget_world(const std::string& world);

    /// Called by the simulation thread with its events: puts them into the outbox if a session is subscribed to events.
    std::function<void(const simulation::Laboratory&, std::vector<simulation::Event>)> outlet(runtime::Outbox& outbox);
    /// Keeps the snapshots for send_some(), and counts dropped events.
    void deliver(runtime::Outbox::Taken taken);
    /// Distributes the next islands of snapshots to the sessions. true: more are left for another call.
    bool send_some(runtime::Clock::time_point now) { return snapshots_.distribute(now); }
    /// Sends an event to the sessions that are subscribed to it.
    void publish(v1::Event event);
    /// Sends the event that the server is shutting down to all sessions.
    void announce_end();
    /// Ends all sessions after they have received what is queued.
    void end_sessions();

  private:
    void update_demand();

    const Sessions& sessions_;
    runtime::StreamDemand& demand_;
    runtime::Mailbox& mailbox_;
    streaming::SnapshotStreams snapshots_;
};

} // namespace evod::network
