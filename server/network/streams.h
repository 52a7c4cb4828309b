// Streams: who watches what, and the way of pictures and events from the simulation to their sessions.
//
// A picture is encoded once per island, whoever gets it; the sessions share the bytes.
//
// Owner        the server; on the network thread.
#pragma once

#include "server/network/session.h"
#include "server/runtime/demand.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/outbox.h"

#include <map>

namespace evod::network {

/// By session number.
using Sessions = std::map<std::uint64_t, SessionPtr>;

class Streams {
  public:
    /// Everything handed in outlives the streams.
    Streams(const Sessions& sessions, runtime::Demand& demand, runtime::Mailbox& mailbox)
        : sessions_{sessions}, demand_{demand}, mailbox_{mailbox} {}

    std::uint32_t subscribe(Session& session, SnapshotSubscription subscription);
    std::uint32_t subscribe(Session& session, EventSubscription subscription);
    /// false: the session has no such subscription.
    bool unsubscribe(Session& session, std::uint32_t subscription_id);

    /// To be called when the subscriptions of a session have gone with it.
    void update_demand();

    void show(const runtime::Outbox::Picture& picture, runtime::Clock::time_point now);
    void tell(v1::Event event);
    /// Events were lost on their way here.
    void count_dropped_events(std::uint64_t count);

  private:
    const Sessions& sessions_;
    runtime::Demand& demand_;
    runtime::Mailbox& mailbox_;
    std::uint64_t newcomers_ = 0;
};

/// Fields 1 to 49 of the SnapshotFrame of one island.
SharedBytes encode_picture(const runtime::Snapshot& snapshot, const runtime::IslandSnapshot& island);

} // namespace evod::network
