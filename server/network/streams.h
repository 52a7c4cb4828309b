// Streams: who watches what, and the way of pictures and events from the simulation to their sessions.
//
// A picture is encoded once per island, whoever gets it; the sessions share the bytes. Those who take deltas of a world
// at one rate, whole or in tiles, form a group, which is shown the same pictures.
//
// A world of thousands of islands takes the network thread a tenth of a second. Its islands are therefore handed out in
// several turns, between which the thread serves other clients and other worlds.
//
// Owner        the server; on the network thread.
#pragma once

#include "server/network/session.h"
#include "server/runtime/demand.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/outbox.h"

#include <compare>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace evod::network {

/// By session number.
using Sessions = std::map<std::uint64_t, SessionPtr>;

class EncodedIsland;

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
    /// Runs the deliveries from there, and keeps the pictures for send_some().
    void deliver(runtime::Outbox::Taken taken);
    /// Hands the next islands of pictures to the sessions. true: there are more, for another call.
    bool send_some(runtime::Clock::time_point now);
    void tell(v1::Event event);
    /// Tells all sessions that the server goes away.
    void announce_end();
    /// Ends them, once they have read what waits for them.
    void end_sessions();

  private:
    void update_demand();
    /// The viewers of a world at one rate that take deltas, whole or in tiles.
    struct Group {
        runtime::Clock::time_point next_picture;                // not before then
        std::map<std::uint32_t, streaming::DeltaStream> chains; // by island, of those that are watched whole
        std::map<std::uint32_t, streaming::TiledSnapshotPtr>
            tiled;                // the newest by island, of those that are watched in tiles
        simulation::RunId run_id; // of these
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
    using SubscriptionName = std::pair<std::uint64_t, std::uint32_t>; // number of the session, subscription id
    /// A picture whose islands are being handed out.
    struct InProgress {
        runtime::Outbox::Picture picture;
        bool begun = false;
        runtime::Clock::time_point began = {};
        std::size_t next_island = 0;                       // in the picture
        std::set<GroupName> groups = {};                   // that are shown it
        std::set<SubscriptionName> subscriptions = {};     // the same of those that are in no group
        std::optional<runtime::Outbox::Picture> next = {}; // of the same world
    };
    /// Chooses who is shown it.
    void begin(InProgress& of, runtime::Clock::time_point now);
    /// Hands out islands until none is left, or no step: each island takes one, and one for each viewer.
    void advance(InProgress& of, std::size_t& steps_left);
    struct Viewer;
    std::vector<Viewer> viewers_of(const InProgress& of);
    SnapshotSubscription::Waiting encode_for(const Viewer& viewer, EncodedIsland& island, const InProgress& of);
    static GroupName group_of(const SnapshotSubscription& subscription);
    /// Calls what(island, picture) for each island that the subscription is shown.
    template <class Do>
    void each_newest(const SnapshotSubscription& subscription, const Do& what) const;

    const Sessions& sessions_;
    runtime::Demand& demand_;
    runtime::Mailbox& mailbox_;
    std::uint64_t newcomers_ = 0, sequence_ = 0;
    codec::Compressor compressor_;
    std::map<GroupName, Group> groups_;
    std::deque<InProgress> in_progress_; // at most one of a world
};

} // namespace evod::network
