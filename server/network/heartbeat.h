// Heartbeat: checks for /healthz whether the simulation thread responds.
//
// Owner        the server, on the network thread.
// Full         the mailbox contains at most one Ping. All pending checks wait for its Pong.
#pragma once

#include "server/runtime/mailbox.h"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <set>

namespace evod::network {

class Heartbeat {
  public:
    /// The mailbox must outlive the heartbeat.
    explicit Heartbeat(runtime::Mailbox& mailbox) : mailbox_{mailbox} {}

    /// Returns whether the simulation thread responds within `patience`.
    boost::asio::awaitable<bool> answers_within(std::chrono::milliseconds patience);
    /// Must be called when a Pong has come.
    void answered();
    /// Makes all pending checks fail. Called when the simulation thread has stopped.
    void stop();

  private:
    runtime::Mailbox& mailbox_;
    bool asked_ = false, stopped_ = false;
    std::set<boost::asio::steady_timer*> waiting_; // timers of the pending checks; answered() cancels them
};

} // namespace evod::network
