// Session table: accepts connections as sessions, and contains the sessions.
//
// Owner        the server, on the network thread.
// Full         if there are too many sessions, of all clients or of one address, the oldest session without a Hello makes
//              room, so that a silent connection cannot keep other clients out. If there is none, the connection is
//              refused. At most farewells_max refused connections receive a Goodbye at the same time.
#pragma once

#include "server/network/limits.h"
#include "server/network/session.h"
#include "server/network/transport.h"

#include <cstdint>
#include <memory>

namespace evod::network {

class SessionTable {
  public:
    /// host  must outlive the table.
    SessionTable(SessionHost& host, const SessionBounds& bounds) : host_{host}, bounds_{bounds} {}

    const Sessions& sessions() const { return sessions_; }
    /// Starts a session on a connection, or refuses the connection.
    void accept(std::unique_ptr<Transport> transport);
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

  private:
    SessionHost& host_;
    const SessionBounds bounds_;
    Sessions sessions_;
    std::uint64_t last_number_ = 0, ended_count_ = 0;
    std::size_t connection_count_ = 0; // sessions, and refused connections that are receiving a Goodbye
    bool going_away_ = false;
};

} // namespace evod::network
