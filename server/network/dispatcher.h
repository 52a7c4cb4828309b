// Dispatcher: from a request to its answer. Decides what a request may do, sends it to the simulation, and sees to it
// that a command is never run twice.
//
// Owner        the server; on the network thread. What it puts into the mailbox runs on the simulation thread, reads
// the
//              laboratory there, and comes back through the outbox.
#pragma once

#include "server/network/breedings.h"
#include "server/network/exports.h"
#include "server/network/leases.h"
#include "server/network/limits.h"
#include "server/network/retries.h"
#include "server/network/session.h"
#include "server/network/streams.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/outbox.h"

namespace evod::network {

class Dispatcher {
  public:
    /// Everything handed in outlives the dispatcher, and the simulation thread ends before it.
    /// shut_down  ends the server.
    /// metrics    what it counts.
    Dispatcher(asio::io_context& context, runtime::Mailbox& mailbox, runtime::Outbox& outbox,
               runtime::StreamDemand& demand, Streams& streams, LimitCounters& limit_counters,
               std::function<void()> shut_down, std::function<v1::Metrics()> metrics);

    void handle(Session& session, v1::Request request);

    /// A command of the server itself. lease: of ReleaseLease. A refusal is logged; one for want of room in the mailbox
    /// comes to nothing.
    void handle_own(v1::Request request, std::optional<std::uint64_t> lease = {});
    /// A world that was lent before this server started: it goes on, unless its lease is renewed.
    void lend_again(const std::string& world) { leases_.begin(world, 0, {}); }

    /// Answers that were given before this server started.
    void restore(const std::vector<run_file::JournalEntry>& answers);

    /// A session has ended: what it looked at is let go of.
    void forget(const Session& session);

    /// From now on every request is refused: the server is going away.
    void refuse_all() {
        going_away_ = true;
        leases_.end_all();
    }

  private:
    /// A request that was admitted.
    void serve(Session& session, v1::Request request);
    /// What was held back for the query that is answered now.
    void serve_held_back(Session& session);
    void command(Session& session, const v1::Request& request);
    void query(Session& session, v1::Request request);
    void subscription(Session& session, const v1::Request& request);
    void past(Session& session, const v1::Request& request);
    void export_text(Session& session, const v1::Request& request);
    void breeding(Session& session, const v1::Request& request);
    /// Finds the file of a world's run for `then`, which runs here if the session is still there. A refusal is
    /// answered.
    using Found = std::function<void(Session&, runtime::FoundRun)>;
    void find_run(Session& session, const v1::Request& request, const std::string& world, Found then);
    void renew_lease(Session& session, const v1::Request& request);

    /// The encoded response to a command, here, once it cannot be lost any more. refused: nullptr if it was applied.
    using Answered = std::function<void(const SharedBytes& frame, const base::Refusal* refused)>;
    struct From {
        std::uint64_t session; // number; 0: the server itself
        std::string by;
        std::string user; // name of its token; empty: none
    };
    /// Hands a command to the simulation, and tells everybody of it. false: the mailbox is full.
    bool carry_out(simulation::Command command, const v1::Request& request, const From& from, Answered answered);

    /// The mailbox is full.
    base::Refusal busy();
    /// Asks the simulation; `answer` runs there and fills in the response.
    using Answer = std::function<void(const simulation::Laboratory&, v1::Response&)>;
    void ask(Session& session, std::uint64_t request_id, Answer answer);
    /// The same, for an answer that has to be finished here, by `then`, which may use the session: it is still there.
    /// false: there is no room to ask, and the session has been told so.
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
    Breedings breedings_;
    Leases leases_;
    Retries retries_;
    const std::string own_key_; // client_key of the server's own commands
    std::uint64_t own_request_id_ = 0;
    bool going_away_ = false;
};

} // namespace evod::network
