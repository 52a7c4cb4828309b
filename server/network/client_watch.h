// Client watch: recognises clients that receive nothing, and clients of WebSockets that send nothing.
//
// Owner        the session, which calls it periodically on the network thread.
#pragma once

#include "server/network/limits.h"
#include "server/network/transport.h"
#include "server/runtime/clock.h"

#include <optional>

namespace evod::network {

class ClientWatch {
  public:
    using Duration = runtime::Clock::duration;

    /// Must be called before and after the session waits for bytes of the client.
    void begin_read() { silent_ = Duration{}; }
    void end_read() { silent_.reset(); }

    /// Whether the client has received nothing for stalled_timeout.
    ///
    /// sent     nullopt: the session sends nothing at present.
    /// watched  the part of the time since the last call in which the server was able to observe the client.
    bool is_stalled(const std::optional<Transport::Progress>& sent, Duration watched);

    enum class Silence { Short, PingDue, TooLong };
    /// Whether the client has sent nothing for a time in which the session has read. Returns PingDue once.
    Silence silence_after(Duration watched);

  private:
    std::optional<Transport::Progress> sent_;
    Duration stalled_{};             // time in which the client was observed and received nothing
    std::optional<Duration> silent_; // time for which the present read has waited; nullopt: the session does not read
};

} // namespace evod::network
