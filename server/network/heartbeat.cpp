#include "server/network/heartbeat.h"

#include "server/network/no_throw.h"

#include <boost/asio/this_coro.hpp>

#include <utility>

namespace evod::network {

namespace asio = boost::asio;

asio::awaitable<bool> Heartbeat::answers_within(std::chrono::milliseconds patience) {
    if (stopped_) {
        co_return false;
    }
    asio::steady_timer timer{co_await asio::this_coro::executor, patience};
    waiting_.insert(&timer);
    // push() ignores the capacity of the mailbox. The heartbeat adds at most one entry at a time.
    if (!std::exchange(asked_, true)) {
        mailbox_.push(runtime::Ping{});
    }
    const auto [cancelled] = co_await timer.async_wait(no_throw);
    waiting_.erase(&timer);
    co_return cancelled && !stopped_;
}

void Heartbeat::answered() {
    asked_ = false;
    for (asio::steady_timer* timer : waiting_) {
        timer->cancel();
    }
}

void Heartbeat::stop() {
    stopped_ = true;
    answered();
}

} // namespace evod::network
