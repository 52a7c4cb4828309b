// Dispatcher: handles each request and sends its answer. It checks the role, and passes requests on: commands to
// Commands, queries to the simulation thread, exports to BackgroundQueries.
//
// Owner        the server.
// Threads      the network thread. Requests go to the simulation thread as data (server/runtime/mail.h) and come back
//              as data (server/runtime/replies.h), as do the results of background queries.
#pragma once

#include "server/network/background_queries.h"
#include "server/network/class_requests.h"
#include "server/network/commands.h"
#include "server/network/heartbeat.h"
#include "server/network/replay_places.h"
#include "server/network/session.h"
#include "server/network/streams.h"
#include "server/protocol/queries.h"
#include "server/runtime/outbox.h"
#include "server/runtime/simulations.h"

namespace evod::network {

class Dispatcher {
  public:
    /// All arguments must outlive the dispatcher.
    ///
    /// replays_max  maximum number of replays of all sessions.
    /// classes      the classes of students.
    /// shut_down    shuts the server down.
    /// metrics      returns the current metrics.
    Dispatcher(asio::io_context& context, runtime::Simulations& simulations, runtime::Outbox& outbox,
               const Sessions& sessions, Streams& streams, SessionHost& host, std::size_t replays_max,
               classes::Registry& classes, std::function<void()> shut_down, std::function<v1::Metrics()> metrics);

    void handle(Session& session, v1::Request request);
    /// Handles deliveries from the outbox in order.
    void deliver(std::vector<runtime::Delivery> deliveries);
    /// Returns whether the simulation thread responds within `patience`.
    asio::awaitable<bool> simulation_answers_within(std::chrono::milliseconds patience) {
        return heartbeat_.answers_within(patience);
    }

    Commands& commands() { return commands_; }
    const ReplayPlaces& replay_places() const { return replay_places_; }
    ClassRequests& class_requests() { return class_requests_; }
    BackgroundQueries& background_queries() { return background_queries_; }
    /// Sets the rules of a class for its worlds. Calls `done` with all its worlds when they hold.
    ///
    /// rules  nullopt: the class is deleted.
    void set_class(const std::string& name, std::optional<simulation::ClassRules> rules, base::Actor by,
                   std::function<void(const std::vector<std::string>& worlds)> done);
    /// Commands::handle_own().
    void handle_own(v1::Request request) { commands_.handle_own(std::move(request)); }

    /// Must be called when a session has ended. Cancels its exports and breeding queries, and closes its replays.
    void forget(const Session& session);

    /// Makes the dispatcher refuse all further requests, because the server is shutting down.
    void refuse_all() {
        going_away_ = true;
        heartbeat_.stop();
        commands_.end_all_leases();
    }

  private:
    ClassActions class_actions();
    /// Handles a request that the session has admitted.
    void serve(Session& session, v1::Request request);
    void query(Session& session, v1::Request request);
    /// Counts the memory of results that have arrived, until their answers are complete.
    void expect_results(const std::vector<runtime::Delivery>& deliveries);
    // The following functions complete the answer to a request and send it, if the session still exists.
    void on_done(runtime::QueryDone done);
    void on_done(runtime::ReplayDone done);
    void on_done(runtime::ClassSet done);
    void on_done(runtime::RunFound done);
    void on_done(const runtime::ReplayMemory& memory);
    void on_done(const runtime::ReplayEnded& ended);
    void on_storage(const runtime::StorageChanged& changed);
    /// Ends the lease and the snapshot streams of a world that has become damaged, and publishes the event.
    void on_damaged(const simulation::DamagedWorld& damaged);
    /// Puts mail into the mailbox of the thread that has this world. If the mailbox is full, refuses the request and
    /// returns false.
    bool ask(Session& session, std::uint64_t request_id, std::string_view world, runtime::Mail mail);
    /// Sends a query to the simulation thread. The session's further requests are held back until it is answered.
    void ask(Session& session, v1::Request request);
    void find_run(Session& session, v1::Request request);
    /// Handles a request of the kind REQUEST_KIND_REPLAY.
    void serve_replay(Session& session, const v1::Request& request);
    /// Closes a replay that has lost its place.
    void end_replay(const ReplayPlaces::Place& place);

    runtime::Simulations& simulations_;
    const Sessions& sessions_;
    Streams& streams_;
    SessionHost& host_;
    std::function<void()> shut_down_;
    std::function<v1::Metrics()> metrics_;
    BackgroundQueries background_queries_;
    Heartbeat heartbeat_;
    Commands commands_;
    ClassRequests class_requests_;
    ReplayPlaces replay_places_;
    std::map<std::uint64_t, std::function<void(const std::vector<std::string>& worlds)>>
        class_waiters_; // key: ClassSet::number
    std::uint64_t last_class_change_ = 0;
    bool going_away_ = false;
};

} // namespace evod::network
