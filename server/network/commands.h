// Commands: passes the commands of clients to the simulation thread, and uses the reply cache to make them idempotent.
// Also sends the commands of the server itself, and limits the leases that commands grant.
//
// Owner        the dispatcher, on the network thread.
#pragma once

#include "server/network/leases.h"
#include "server/network/reply_cache.h"
#include "server/network/session.h"
#include "server/network/streams.h"
#include "server/runtime/simulations.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace evod::network {

/// Returns the refusal for a full mailbox, and counts it.
base::Refusal mailbox_full(LimitCounters& limit_counters);

class Commands {
  public:
    /// All arguments must outlive this object.
    Commands(asio::io_context& context, runtime::Simulations& simulations, Streams& streams,
             LimitCounters& limit_counters);

    /// Handles a command that the session has admitted.
    void handle(Session& session, const v1::Request& request);
    /// Sends a command on behalf of the server itself. If the command is refused, the refusal is logged. If the mailbox
    /// is full, the command is dropped.
    ///
    /// lease  for ReleaseLease: the number of the lease.
    void handle_own(v1::Request request, std::optional<std::uint64_t> lease = {});
    /// Creates a world on behalf of the server. If it exists already, nothing happens. Returns false if the mailbox is
    /// full.
    bool create_own(v1::Request request, simulation::Ownership ownership);
    /// Must be called after a command was refused, or was applied and stored. Sends the answer and reports the change
    /// to subscribers.
    void on_done(runtime::CommandDone done);
    /// Must be called when the worlds of a ForEachWorld are known.
    void on_begun(runtime::BatchBegun begun);

    /// The keys in the reply cache, by user.
    const base::Quota& cached_keys() const { return reply_cache_.key_quota(); }
    /// Adds to the reply cache what was known before this server started.
    ///
    /// keys  oldest first. They may contain keys of `answers`.
    void restore(const std::vector<run_file::UsedKey>& keys, const std::vector<run_file::JournalEntry>& answers);
    /// Starts a lease that was granted before the server started. When it expires, the world continues.
    void restart_lease(const std::string& world) { leases_.begin(world, 0, {}); }
    /// Returns nullopt if the session's user holds the lease of the world with the client_key of this request;
    /// otherwise the refusal.
    std::optional<base::Refusal> renew_lease(const Session& session, const v1::Request& request,
                                             const std::string& world);
    void end_lease(const std::string& world) { leases_.end(world); }
    /// Ends all leases, because the server is shutting down. No lease begins afterwards.
    void end_all_leases();

  private:
    /// Puts a command into the mailbox. Returns false if the mailbox is full.
    ///
    /// bytes    the serialised request.
    /// sender   nullptr: the server itself.
    bool send(simulation::Command command, const v1::Request& request, std::string bytes, const Session* sender);
    void on_refused(const runtime::CommandMail& mail, const base::Refusal& why, const SharedBytes& frame);
    /// Sends a ForEachWorld to the simulation thread. Returns false if its mailbox is full.
    bool send_for_each(const v1::Request& request, const Session& sender);
    /// A command of a ForEachWorld was refused, or was applied and stored.
    void on_one_done(const runtime::CommandDone& done);
    /// Answers a ForEachWorld if all its commands are done.
    void answer_if_complete(std::uint64_t batch);

    runtime::Simulations& simulations_;
    Streams& streams_;
    LimitCounters& limit_counters_;
    Leases leases_;
    ReplyCache reply_cache_;
    /// A ForEachWorld under way.
    struct Batch {
        UserKey key;
        std::uint64_t request_id = 0;
        std::optional<std::vector<std::string>> worlds; // in the order of the answer; nullopt: they are not known yet
        std::map<std::string, v1::WorldResult> done;    // by world
    };
    std::map<std::uint64_t, Batch> batches_;
    std::uint64_t last_batch_ = 0;
    const std::string own_key_; // client_key for commands of the server itself
    std::uint64_t own_request_id_ = 0;
    bool grants_leases_ = true;
};

} // namespace evod::network
