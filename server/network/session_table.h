// Session table: accepts connections as sessions, and contains the sessions.
//
// Owner        the server, on the network thread.
// Full         a connection becomes a newcomer, which counts for its address until its Hello. If there are too many,
//              the oldest newcomer makes room: of the same address if it holds half of the places, otherwise of the
//              address with the most. With its Hello it needs one of the places of its account (base::Quota). If none
//              is free, the account with the most sessions loses its oldest one without a command under way. A member
//              of a class who has member_sessions_max loses the oldest. While
//              farewells_max connections receive a Goodbye, the oldest of them is closed at once for each new one.
#pragma once

#include "server/base/quota.h"
#include "server/network/limits.h"
#include "server/network/session.h"
#include "server/network/transport.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace evod::network {

class SessionTable {
  public:
    /// host  must outlive the table.
    SessionTable(SessionHost& host, std::uint32_t sessions_max) : host_{host}, sessions_max_{sessions_max} {}

    const Sessions& sessions() const { return sessions_; }
    /// Starts a session on a connection, which is a newcomer at first.
    void accept(std::unique_ptr<Transport> transport);
    /// Makes room for one more session of this account after its Hello. Returns nullopt, or why there is none.
    std::optional<base::Refusal> make_room(const std::string& account);
    /// Must be called when a session has ended, even if its connection was refused.
    void forget(const Session& session);
    /// Number of sessions that have ended.
    std::uint64_t ended_count() const { return ended_count_; }
    /// Refuses all further connections, because the server is shutting down.
    void refuse_all() { going_away_ = true; }
    /// Closes sessions until all together are within the limit of SendMemory, and no user holds more than half of it. A
    /// session belongs to the user who holds the most then, and is the one that uses the most memory, but sessions with
    /// a command under way come last. If one session holds nearly all that its user holds, it may be more than
    /// half, because the session may show a large world.
    void evict();

    /// The places that sessions hold, by account.
    base::Quota places() const;
    /// The places that connections without a Hello hold, by address.
    base::Quota newcomers() const;

  private:
    /// Limits the number of sessions that are over, but have not ended yet.
    void limit_farewells();
    /// Ends the oldest session of a member of a class who has as many as a member may have.
    void end_oldest_of_member(const std::string& account);

    SessionHost& host_;
    const std::uint32_t sessions_max_;
    Sessions sessions_;
    std::uint64_t last_number_ = 0, ended_count_ = 0;
    bool going_away_ = false;
};

} // namespace evod::network
