// Heartbeat: checks for /healthz whether the simulation thread responds.
//
// Owner        the server, on the network thread.
// Full         the mailbox contains at most one call from the heartbeat. All pending checks wait for that call.
#pragma once

#include "server/runtime/mailbox.h"
#include "server/runtime/outbox.h"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <set>

namespace evod::network {

class Heartbeat {
  public:
    /// The mailbox and the outbox must outlive the heartbeat. The simulation thread must end before it is destroyed.
    Heartbeat(runtime::Mailbox& mailbox, runtime::Outbox& outbox) : mailbox_{mailbox}, outbox_{outbox} {}

    /// Returns whether the simulation thread responds within `patience`.
    boost::asio::awaitable<bool> answers_within(std::chrono::milliseconds patience);
    /// Makes all pending checks fail. Called when the simulation thread has stopped.
    void stop();

  private:
    void answered();

    runtime::Mailbox& mailbox_;
    runtime::Outbox& outbox_;
    bool asked_ = false, stopped_ = false;
    std::set<boost::asio::steady_timer*> waiting_; // timers of the pending checks; answered() cancels them
};

} // namespace evod::network
