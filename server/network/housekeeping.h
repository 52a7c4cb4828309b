// Housekeeping: the periodic checks of the server: revoked tokens, stalled clients, free memory.
//
// Owner        the server, on the network thread.
#pragma once

#include "server/access/authentication.h"
#include "server/network/session_table.h"
#include "server/runtime/clock.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include <cstdint>

namespace evod::network {

class Housekeeping {
  public:
    /// All arguments must outlive this object.
    Housekeeping(asio::io_context& context, const SessionTable& table, SessionHost& host)
        : table_{table}, host_{host}, timer_{context} {}

    /// authenticator  must outlive the checks.
    void start(access::Authenticator& authenticator);
    void stop() { timer_.cancel(); }

  private:
    void schedule(access::Authenticator& authenticator);
    void check_tokens(access::Authenticator& authenticator);
    void check_clients(runtime::Clock::time_point now);
    /// Returns free memory to the system. Answered requests and ended sessions leave fragmented free memory, which
    /// malloc does not return by itself.
    void trim_heap(runtime::Clock::time_point now);

    const SessionTable& table_;
    SessionHost& host_;
    asio::steady_timer timer_;
    runtime::Clock::time_point checked_at_, trim_at_;
    std::uint64_t ended_at_trim_ = 0;    // number of sessions that had ended at the last trim
    std::uint64_t answered_at_trim_ = 0; // number of bytes of answers sent until then
};

} // namespace evod::network
