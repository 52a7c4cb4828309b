// Streams: who watches what, and the way of pictures and events from the simulation to their sessions.
//
// A picture is encoded once per island, whoever gets it; the sessions share the bytes. Those who take deltas of a world
// at one rate, whole or in tiles, form a group, which is shown the same pictures.
//
// Owner        the server; on the network thread.
#pragma once

#include "server/network/session.h"
#include "server/runtime/demand.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/outbox.h"

#include <compare>
#include <functional>
#include <map>
#include <string>
#include <vector>

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
    /// Sends the newest pictures of a subscription as keyframes. false: the session has no such subscription.
    bool send_keyframes(Session& session, std::uint32_t subscription_id);
    /// Shows something else of the newest pictures, and of those that follow. The session has the subscription, and
    /// that has a view.
    void set_view(Session& session, std::uint32_t subscription_id, const v1::View& view);

    /// The session has gone from the table.
    void forget(const Session& session);

    /// A world is gone: nothing of it is sent any more.
    void forget_world(const std::string& world);

    /// What the simulation thread does with events: it puts them into the outbox, as long as somebody wants them.
    std::function<void(const simulation::Laboratory&, std::vector<simulation::Event>)> outlet(runtime::Outbox& outbox);
    /// What has come from there.
    void deliver(runtime::Outbox::Taken taken, runtime::Clock::time_point now);
    void tell(v1::Event event);
    /// Tells all sessions that the server goes away.
    void announce_end();
    /// Ends them, once they have read what waits for them.
    void end_sessions();

  private:
    void update_demand();
    void show(const runtime::Outbox::Picture& picture, runtime::Clock::time_point now);
    /// The viewers of a world at one rate that take deltas, whole or in tiles.
    struct Group {
        runtime::Clock::time_point next_picture;        // not before then
        std::map<std::uint32_t, Chain> chains;          // by island, of those that are watched whole
        std::map<std::uint32_t, TiledPicturePtr> tiled; // the newest by island, of those that are watched in tiles
        simulation::RunId run_id;                       // of these
        void forget_pictures() {
            chains.clear();
            tiled.clear();
        }
    };
    struct GroupName {
        std::string world;
        double rate_hz;
        bool in_tiles;
        friend auto operator<=>(const GroupName&, const GroupName&) = default;
    };
    static GroupName group_of(const SnapshotSubscription& subscription);
    /// Calls what(island, picture) for each island that the subscription is shown.
    template <class Do>
    void each_newest(const SnapshotSubscription& subscription, const Do& what) const;

    const Sessions& sessions_;
    runtime::Demand& demand_;
    runtime::Mailbox& mailbox_;
    std::uint64_t newcomers_ = 0, sequence_ = 0;
    wire::Compressor compressor_;
    std::map<GroupName, Group> groups_;
};

} // namespace evod::network
