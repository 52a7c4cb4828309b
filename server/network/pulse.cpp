#include "server/network/pulse.h"

#include "server/network/no_throw.h"

#include <boost/asio/this_coro.hpp>

#include <utility>

namespace evod::network {

namespace asio = boost::asio;

asio::awaitable<bool> Pulse::beats(std::chrono::milliseconds patience) {
    if (stopped_) {
        co_return false;
    }
    asio::steady_timer timer{co_await asio::this_coro::executor, patience};
    waiting_.insert(&timer);
    // However full the mailbox is: this is one.
    if (!std::exchange(asked_, true)) {
        mailbox_.push(runtime::CallMail{[this] { outbox_.answer([this] { answered(); }); }});
    }
    const auto [cancelled] = co_await timer.async_wait(no_throw);
    waiting_.erase(&timer);
    co_return cancelled && !stopped_;
}

void Pulse::answered() {
    asked_ = false;
    for (asio::steady_timer* timer : waiting_) {
        timer->cancel();
    }
}

void Pulse::stop() {
    stopped_ = true;
    answered();
}

} // namespace evod::network
