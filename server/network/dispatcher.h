// Dispatcher: takes a request to its answer. Checks the role, sends commands and queries to the simulation, and makes
// commands idempotent through the reply cache.
//
// Owner        the server.
// Threads      the network thread. The simulation thread runs only the functions given to ask(), which read the
//              laboratory. Commands travel as data (server/runtime/commands.h).
#pragma once

#include "server/network/breeding_queries.h"
#include "server/network/exports.h"
#include "server/network/leases.h"
#include "server/network/limits.h"
#include "server/network/reply_cache.h"
#include "server/network/session.h"
#include "server/network/streams.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/outbox.h"

namespace evod::network {

class Dispatcher {
  public:
    /// Everything handed in outlives the dispatcher. The simulation thread ends before it.
    ///
    /// shut_down  ends the server.
    /// metrics    returns the current metrics.
    Dispatcher(asio::io_context& context, runtime::Mailbox& mailbox, runtime::Outbox& outbox,
               runtime::StreamDemand& demand, Streams& streams, LimitCounters& limit_counters,
               std::function<void()> shut_down, std::function<v1::Metrics()> metrics);

    void handle(Session& session, v1::Request request);
    /// Handles the deliveries of the outbox in order.
    void deliver(std::vector<runtime::Delivery> deliveries);

    /// Sends a command of the server itself. A refusal is logged. If the mailbox is full, the command is dropped.
    ///
    /// lease  for ReleaseLease: the number of the lease.
    void handle_own(v1::Request request, std::optional<std::uint64_t> lease = {});
    /// A world whose lease is older than this server: it continues unless the lease is renewed.
    void lend_again(const std::string& world) { leases_.begin(world, 0, {}); }

    /// Puts answers given before this server started into the reply cache.
    void restore(const std::vector<run_file::JournalEntry>& answers);

    /// The session has ended: closes its exports, breeding queries and replays.
    void forget(const Session& session);

    /// From now on refuses every request: the server is shutting down.
    void refuse_all() {
        going_away_ = true;
        leases_.end_all();
    }

  private:
    /// Handles an admitted request.
    void serve(Session& session, v1::Request request);
    /// Handles the requests that waited for the query just answered.
    void serve_held_back(Session& session);
    void command(Session& session, const v1::Request& request);
    void query(Session& session, v1::Request request);
    void subscription(Session& session, const v1::Request& request);
    /// Changes the view of a subscription.
    void set_view(Session& session, const v1::Request& request);
    void replay(Session& session, const v1::Request& request);
    void export_text(Session& session, const v1::Request& request);
    void breeding(Session& session, const v1::Request& request);
    /// Finds the run file of a world and calls `then` on this thread, if the session still exists. A refusal becomes
    /// the answer.
    using Found = std::function<void(Session&, runtime::FoundRun)>;
    void find_run(Session& session, const v1::Request& request, const std::string& world, Found then);
    void renew_lease(Session& session, const v1::Request& request);

    /// Puts a command into the mailbox. false: the mailbox is full.
    ///
    /// bytes    the serialised request.
    /// by       the sender, as protocol::actor_of() reads it.
    /// session  number of the sender's session; 0: the server itself.
    bool send(simulation::Command command, const v1::Request& request, std::string bytes, std::string by,
              std::uint64_t session);
    /// A command was applied or refused, and cannot be lost any more: answers it and reports it to subscribers.
    void on_done(runtime::CommandDone done);
    /// key  of the reply cache.
    void on_refused(const runtime::CommandMail& mail, const base::Refusal& why, const std::string& key,
                    const SharedBytes& frame);

    /// The refusal for a full mailbox.
    base::Refusal busy();
    /// Sends a query to the simulation thread, which calls `answer` to fill in the response.
    using Answer = std::function<void(const simulation::Laboratory&, v1::Response&)>;
    void ask(Session& session, std::uint64_t request_id, Answer answer);
    /// Likewise; then `then` completes the response on this thread. The session still exists when it is called. false:
    /// the mailbox is full, and the request has been refused.
    using Then = std::function<void(Session&, v1::Response&)>;
    bool ask(Session& session, std::uint64_t request_id, Answer answer, Then then);

    runtime::Mailbox& mailbox_;
    runtime::Outbox& outbox_;
    runtime::StreamDemand& demand_;
    Streams& streams_;
    LimitCounters& limit_counters_;
    std::function<void()> shut_down_;
    std::function<v1::Metrics()> metrics_;
    Exports exports_;
    BreedingQueries breeding_queries_;
    Leases leases_;
    ReplyCache reply_cache_;
    const std::string own_key_; // client_key of the server's own commands
    std::uint64_t own_request_id_ = 0;
    bool going_away_ = false;
};

} // namespace evod::network
