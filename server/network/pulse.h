// Pulse: whether the simulation thread answers.
//
// Owner        the server; on the network thread.
// Full         one question is on its way at most, whoever waits for its answer.
#pragma once

#include "server/runtime/mailbox.h"
#include "server/runtime/outbox.h"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <set>

namespace evod::network {

class Pulse {
  public:
    /// What is handed in outlives the pulse, and the simulation thread ends before it.
    Pulse(runtime::Mailbox& mailbox, runtime::Outbox& outbox) : mailbox_{mailbox}, outbox_{outbox} {}

    /// Whether it answers within that time.
    boost::asio::awaitable<bool> beats(std::chrono::milliseconds patience);
    /// It does not any more: nobody is left waiting.
    void stop();

  private:
    void answered();

    runtime::Mailbox& mailbox_;
    runtime::Outbox& outbox_;
    bool asked_ = false, stopped_ = false;
    std::set<boost::asio::steady_timer*> waiting_; // cancelled when the answer comes
};

} // namespace evod::network
