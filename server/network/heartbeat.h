// Heartbeat: checks that the simulation thread responds, for /healthz.
//
// Owner        the server, on the network thread.
// Full         at most one call is in the mailbox, however many callers wait for it.
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
    /// Mailbox and outbox outlive the heartbeat. The simulation thread ends before it.
    Heartbeat(runtime::Mailbox& mailbox, runtime::Outbox& outbox) : mailbox_{mailbox}, outbox_{outbox} {}

    /// Whether the simulation thread responds within `patience`.
    boost::asio::awaitable<bool> answers_within(std::chrono::milliseconds patience);
    /// The simulation has stopped: fails all pending checks.
    void stop();

  private:
    void answered();

    runtime::Mailbox& mailbox_;
    runtime::Outbox& outbox_;
    bool asked_ = false, stopped_ = false;
    std::set<boost::asio::steady_timer*> waiting_; // cancelled by the response
};

} // namespace evod::network
