// Signal: lets one coroutine of a session wait until the session wakes it.
//
// Owner        the session, on the network thread. Only one coroutine may wait.
#pragma once

#include "server/network/no_throw.h"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>

#include <utility>

namespace evod::network {

class Signal {
  public:
    using Timer = boost::asio::steady_timer;

    explicit Signal(const boost::asio::any_io_executor& executor) : timer_{executor} {}

    /// Waits for notify(), at most until this time. A notify() before the wait has no effect. Since both run on one
    /// thread, none comes between the caller's last check and the wait.
    boost::asio::awaitable<void> wait(Timer::time_point until = Timer::time_point::max()) {
        is_awaited_ = true;
        timer_.expires_at(until);
        co_await timer_.async_wait(no_throw);
        is_awaited_ = false;
    }
    void notify() {
        if (std::exchange(is_awaited_, false)) {
            timer_.cancel();
        }
    }
    bool is_awaited() const { return is_awaited_; }

  private:
    Timer timer_;
    bool is_awaited_ = false;
};

} // namespace evod::network
