// Dispatcher: handles each request and sends its answer. It checks the role, passes commands and queries to the
// simulation thread, and uses the reply cache to make commands idempotent.
//
// Owner        the server.
// Threads      the network thread. Requests go to the simulation thread as data (server/runtime/mail.h) and come back
//              as data (server/runtime/replies.h), as do the results of background queries.
#pragma once

#include "server/network/background_queries.h"
#include "server/network/heartbeat.h"
#include "server/network/leases.h"
#include "server/network/limits.h"
#include "server/network/reply_cache.h"
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
    /// shut_down  shuts the server down.
    /// metrics    returns the current metrics.
    Dispatcher(asio::io_context& context, runtime::Simulations& simulations, runtime::Outbox& outbox,
               const Sessions& sessions, Streams& streams, SessionHost& host, std::function<void()> shut_down,
               std::function<v1::Metrics()> metrics);

    void handle(Session& session, v1::Request request);
    /// Handles deliveries from the outbox in order.
    void deliver(std::vector<runtime::Delivery> deliveries);
    /// Returns whether the simulation thread responds within `patience`.
    asio::awaitable<bool> simulation_answers_within(std::chrono::milliseconds patience) {
        return heartbeat_.answers_within(patience);
    }

    /// Sends a command on behalf of the server itself. If the command is refused, the refusal is logged. If the mailbox
    /// is full, the command is dropped.
    ///
    /// lease  for ReleaseLease: the number of the lease.
    void handle_own(v1::Request request, std::optional<std::uint64_t> lease = {});
    /// Starts a lease that was granted before the server started. When it expires, the world continues.
    void restart_lease(const std::string& world) { leases_.begin(world, 0, {}); }

    /// Adds to the reply cache the answers that were given before this server started.
    void restore(const std::vector<run_file::JournalEntry>& answers);

    /// Must be called when a session has ended. Cancels its exports and breeding queries, and closes its replays.
    void forget(const Session& session);

    /// Makes the dispatcher refuse all further requests, because the server is shutting down.
    void refuse_all() {
        going_away_ = true;
        heartbeat_.stop();
        leases_.end_all();
    }

  private:
    /// Handles a request that the session has admitted.
    void serve(Session& session, v1::Request request);
    /// Handles the requests that were held back until the session's query was answered.
    void serve_held_back(Session& session);
    void command(Session& session, const v1::Request& request);
    void query(Session& session, v1::Request request);
    void subscription(Session& session, v1::Request request);
    /// Changes the view of a subscription.
    void set_view(Session& session, const v1::Request& request);
    void replay(Session& session, const v1::Request& request);
    void export_text(Session& session, v1::Request request);
    /// Begins the subscription or renews the lease that was requested. Returns nullopt if `response` is complete;
    /// otherwise the refusal.
    std::optional<base::Refusal> apply(const v1::Request& request, const protocol::FoundWorld& world, Session& session,
                                       v1::Response& response);
    std::optional<base::Refusal> subscribe(const v1::SubscribeSnapshots& request, const protocol::FoundWorld& world,
                                           Session& session, v1::Response& response);

    /// Puts a command into the mailbox. Returns false if the mailbox is full.
    ///
    /// bytes    the serialised request.
    /// by       the sender, in the text format that protocol::actor_of() parses.
    /// session  number of the sender's session; 0: the server itself.
    bool send(simulation::Command command, const v1::Request& request, std::string bytes, std::string by,
              std::uint64_t session);
    /// Called after a command was refused, or was applied and stored. Sends the answer and reports the change to
    /// subscribers. The file of a fork is read back first.
    void on_done(runtime::CommandDone done);
    // The following functions complete the answer to a request and send it, if the session still exists.
    void on_done(runtime::QueryDone done);
    void on_done(runtime::ReplayDone done);
    void on_done(runtime::RunFound done);
    void on_done(runtime::ExportPartDone done) { background_queries_.on_done(std::move(done)); }
    void on_done(runtime::BreedingDone done) { background_queries_.on_done(std::move(done)); }
    void on_done(runtime::Pong /*pong*/) { heartbeat_.answered(); }
    void on_storage(const runtime::StorageChanged& changed);
    /// Ends the lease and the snapshot streams of a world that has become damaged, and publishes the event.
    void on_damaged(const simulation::DamagedWorld& damaged);
    /// key  the sender's key in the reply cache.
    void on_refused(const runtime::CommandMail& mail, const base::Refusal& why, const std::string& key,
                    const SharedBytes& frame);

    /// Returns the refusal for a full mailbox.
    base::Refusal busy();
    /// Puts mail into the mailbox of the thread that has this world. If the mailbox is full, refuses the request and
    /// returns false.
    bool ask(Session& session, std::uint64_t request_id, std::string_view world, runtime::Mail mail);
    /// Sends a query to the simulation thread. The session's further requests are held back until it is answered.
    void ask(Session& session, v1::Request request);
    void find_run(Session& session, v1::Request request);

    runtime::Simulations& simulations_;
    const Sessions& sessions_;
    Streams& streams_;
    SessionHost& host_;
    std::function<void()> shut_down_;
    std::function<v1::Metrics()> metrics_;
    BackgroundQueries background_queries_;
    Heartbeat heartbeat_;
    Leases leases_;
    ReplyCache reply_cache_;
    const std::string own_key_; // client_key for commands of the server itself
    std::uint64_t own_request_id_ = 0;
    bool going_away_ = false;
};

} // namespace evod::network
