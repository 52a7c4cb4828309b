// Dispatcher: handles each request and sends its answer. It checks the role, passes commands and queries to the
// simulation thread, and uses the reply cache to make commands idempotent.
//
// Owner        the server.
// Threads      the network thread. The simulation thread runs only the functions given to ask(), which read the
//              laboratory. Commands are passed between the threads as data (server/runtime/commands.h).
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
    /// All arguments must outlive the dispatcher. The simulation thread must end before the dispatcher is destroyed.
    ///
    /// shut_down  shuts the server down.
    /// metrics    returns the current metrics.
    Dispatcher(asio::io_context& context, runtime::Mailbox& mailbox, runtime::Outbox& outbox,
               runtime::StreamDemand& demand, Streams& streams, LimitCounters& limit_counters,
               std::function<void()> shut_down, std::function<v1::Metrics()> metrics);

    void handle(Session& session, v1::Request request);
    /// Handles deliveries from the outbox in order.
    void deliver(std::vector<runtime::Delivery> deliveries);

    /// Sends a command on behalf of the server itself. If the command is refused, the refusal is logged. If the mailbox
    /// is full, the command is dropped.
    ///
    /// lease  for ReleaseLease: the number of the lease.
    void handle_own(v1::Request request, std::optional<std::uint64_t> lease = {});
    /// Starts a lease that was granted before the server started. When it expires, the world continues.
    void lend_again(const std::string& world) { leases_.begin(world, 0, {}); }

    /// Adds to the reply cache the answers that were given before this server started.
    void restore(const std::vector<run_file::JournalEntry>& answers);

    /// Must be called when a session has ended. Cancels its exports and breeding queries, and closes its replays.
    void forget(const Session& session);

    /// Makes the dispatcher refuse all further requests, because the server is shutting down.
    void refuse_all() {
        going_away_ = true;
        leases_.end_all();
    }

  private:
    /// Handles a request that the session has admitted.
    void serve(Session& session, v1::Request request);
    /// Handles the requests that were held back until the session's query was answered.
    void serve_held_back(Session& session);
    void command(Session& session, const v1::Request& request);
    void query(Session& session, v1::Request request);
    void subscription(Session& session, const v1::Request& request);
    /// Changes the view of a subscription.
    void set_view(Session& session, const v1::Request& request);
    void replay(Session& session, const v1::Request& request);
    void export_text(Session& session, const v1::Request& request);
    void breeding(Session& session, const v1::Request& request);
    /// Finds the run file of a world, then calls `then` on the network thread if the session still exists. If the
    /// search is refused, the session receives the refusal as its answer.
    using Found = std::function<void(Session&, runtime::FoundRun)>;
    void find_run(Session& session, const v1::Request& request, const std::string& world, Found then);
    void renew_lease(Session& session, const v1::Request& request);

    /// Puts a command into the mailbox. Returns false if the mailbox is full.
    ///
    /// bytes    the serialised request.
    /// by       the sender, in the text format that protocol::actor_of() parses.
    /// session  number of the sender's session; 0: the server itself.
    bool send(simulation::Command command, const v1::Request& request, std::string bytes, std::string by,
              std::uint64_t session);
    /// Called after a command was refused, or was applied and stored. Sends the answer and reports the change to
    /// subscribers.
    void on_done(runtime::CommandDone done);
    /// key  the sender's key in the reply cache.
    void on_refused(const runtime::CommandMail& mail, const base::Refusal& why, const std::string& key,
                    const SharedBytes& frame);

    /// Returns the refusal for a full mailbox.
    base::Refusal busy();
    /// Sends a query to the simulation thread, which calls `answer` to fill in the response.
    using Answer = std::function<void(const simulation::Laboratory&, v1::Response&)>;
    void ask(Session& session, std::uint64_t request_id, Answer answer);
    /// Like the function above; afterwards `then` completes the response on the network thread. `then` is called only
    /// if the session still exists. Returns false if the mailbox is full; the request has then been refused.
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
    const std::string own_key_; // client_key for commands of the server itself
    std::uint64_t own_request_id_ = 0;
    bool going_away_ = false;
};

} // namespace evod::network
