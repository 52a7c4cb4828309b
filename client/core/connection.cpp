#include "client/core/connection.h"

#include "client/core/protocol_state.h"
#include "client/core/session.h"

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

namespace evod::core {

namespace asio = boost::asio;

namespace {

/// Returns 32 random hexadecimal digits.
std::string random_key() {
    std::random_device device;
    std::string key;
    for (int i = 0; i < 32; ++i) {
        key += "0123456789abcdef"[device() % 16];
    }
    return key;
}

/// The received data, which the program can read at any time.
struct Received {
    ConnectionStatus status = {};
    EventQueue events;
    Answers answers = {};
    Snapshots snapshots = {};
};

} // namespace

/// The connection's thread, timer and socket. They drive the ProtocolState, which only that thread uses.
class Connection::Io {
  public:
    explicit Io(Options options)
        : options_{std::move(options)}, protocol_{options_, random_key(), std::random_device{}(), Clock::now()} {
        asio::post(*context_, [this] { perform(); });
        thread_ = std::thread{[this] { context_->run(); }};
    }

    ~Io() {
        post([this](ProtocolState& protocol) {
            protocol.close();
            guard_.reset();
        });
        thread_.join();
    }

    bool on_own_thread() { return context_->get_executor().running_in_this_thread(); }

    /// Calls change(ProtocolState&) on the connection's thread; then performs the output.
    template <class Change>
    void post(Change change) {
        asio::post(*context_, [this, change = std::move(change)]() mutable {
            change(protocol_);
            perform();
        });
    }

    SubscriptionHandle subscribe(evod::v1::Request request) {
        const SubscriptionHandle handle{++last_handle_};
        post([handle, request = std::move(request)](ProtocolState& protocol) mutable {
            protocol.subscriptions().add(handle, std::move(request));
        });
        return handle;
    }

    /// Locks the mutex, which guards received().
    std::unique_lock<std::mutex> lock() { return std::unique_lock{mutex_}; }
    Received& received() { return received_; }

    /// Waits until `holds()` returns true or the timeout has passed. Locks the mutex as lock() does.
    template <class Condition>
    std::unique_lock<std::mutex> wait(std::chrono::milliseconds timeout, const Condition& holds) {
        std::unique_lock lock{mutex_};
        changed_.wait_for(lock, timeout, holds);
        return lock;
    }

  private:
    void perform() {
        ProtocolState::Output output = protocol_.take_output();
        if (session_ && !output.connection_wanted) {
            session_->close();
            session_.reset();
        } else if (!session_ && output.connection_wanted) {
            session_ = std::make_shared<Session>(context_, options_, protocol_, [this] { perform(); });
            session_->start();
        }
        if (!output.bytes.empty()) {
            session_->send(std::move(output.bytes));
        }
        timer_.cancel();
        if (output.wake_at != TimePoint::max()) {
            timer_.expires_at(output.wake_at);
            timer_.async_wait([this](const boost::system::error_code& error) {
                if (!error) {
                    protocol_.advance(Clock::now());
                    perform();
                }
            });
        }
        publish(output);
        for (Outcome& outcome : output.outcomes) {
            outcome.handler(std::move(outcome.result));
        }
    }

    void publish(ProtocolState::Output& output) {
        {
            const std::lock_guard lock{mutex_};
            received_.status = std::move(output.status);
            received_.answers = std::move(output.answers);
            for (evod::v1::Event& event : output.events) {
                received_.events.push(std::move(event));
            }
            for (auto& [handle, islands] : output.snapshots) {
                islands.merge(received_.snapshots[handle]);
                received_.snapshots[handle] = std::move(islands);
            }
        }
        changed_.notify_all();
    }

    const Options options_;
    std::mutex mutex_;
    std::condition_variable changed_;
    Received received_{.events = EventQueue{options_.events_kept}}; // guarded by the mutex
    std::atomic<std::uint32_t> last_handle_ = 0;

    // Only the connection's thread uses the following members.
    ProtocolState protocol_;
    const std::shared_ptr<asio::io_context> context_ = std::make_shared<asio::io_context>(1);
    asio::executor_work_guard<asio::io_context::executor_type> guard_{context_->get_executor()};
    asio::steady_timer timer_{*context_};
    std::shared_ptr<Session> session_;

    std::thread thread_; // the last member, because the thread uses all others
};

Connection::Connection(Options options) : io_{std::make_unique<Io>(std::move(options))} {}

Connection::~Connection() = default;

ConnectionStatus Connection::status() const {
    const auto lock = io_->lock();
    return io_->received().status;
}

Result<evod::v1::Welcome> Connection::wait_connected(std::chrono::milliseconds timeout) {
    const ConnectionStatus& status = io_->received().status;
    const auto lock = io_->wait(timeout, [&] { return status.state != State::Connecting; });
    switch (status.state) {
    case State::Connected:
        return *status.welcome;
    case State::Connecting:
        return Error{.kind = Error::Kind::Timeout,
                     .what = "not connected within " + std::to_string(timeout.count()) + " ms"};
    default:
        return Error{.kind = status.token_needed ? Error::Kind::TokenNeeded : Error::Kind::NoConnection,
                     .what = status.reason};
    }
}

Result<evod::v1::Response> Connection::request(evod::v1::Request request, std::chrono::milliseconds timeout) {
    if (io_->on_own_thread()) {
        return Error{.kind = Error::Kind::Usage, .what = "a handler must not wait for a request: use send()"};
    }
    return send(std::move(request), timeout).get();
}

void Connection::send(evod::v1::Request request, Handler handler, std::chrono::milliseconds timeout) {
    io_->post([request = std::move(request), handler = std::move(handler), timeout](ProtocolState& protocol) mutable {
        protocol.request(std::move(request), std::move(handler), timeout, Clock::now());
    });
}

std::future<Result<evod::v1::Response>> Connection::send(evod::v1::Request request, std::chrono::milliseconds timeout) {
    auto promise = std::make_shared<std::promise<Result<evod::v1::Response>>>();
    auto future = promise->get_future();
    send(
        std::move(request), [promise](Result<evod::v1::Response> response) { promise->set_value(std::move(response)); },
        timeout);
    return future;
}

SubscriptionHandle Connection::subscribe(evod::v1::SubscribeSnapshots subscription) {
    evod::v1::Request request;
    if (subscription.codec() == evod::v1::CODEC_UNSPECIFIED) {
        // A server without support for these fields ignores them and uses its default codec.
        subscription.set_codec(evod::v1::CODEC_DELTA);
        subscription.set_compression(evod::v1::COMPRESSION_ZSTD);
        subscription.set_unacknowledged_max(unacknowledged_snapshots_max);
        subscription.set_headings(true);
        subscription.set_species(true);
    }
    *request.mutable_subscribe_snapshots() = std::move(subscription);
    return io_->subscribe(std::move(request));
}

SubscriptionHandle Connection::subscribe(evod::v1::SubscribeEvents subscription) {
    evod::v1::Request request;
    *request.mutable_subscribe_events() = std::move(subscription);
    return io_->subscribe(std::move(request));
}

void Connection::set_view(SubscriptionHandle handle, evod::v1::View view) {
    io_->post([handle, view = std::move(view)](ProtocolState& protocol) mutable {
        protocol.subscriptions().set_view(handle, std::move(view));
    });
}

void Connection::unsubscribe(SubscriptionHandle handle) {
    io_->post([io = io_.get(), handle](ProtocolState& protocol) {
        protocol.subscriptions().remove(handle);
        const auto lock = io->lock();
        io->received().snapshots.erase(handle);
    });
}

std::optional<evod::v1::Response> Connection::subscription_answer(SubscriptionHandle handle) const {
    const auto lock = io_->lock();
    const Answers& answers = io_->received().answers;
    const auto answer = answers.find(handle);
    return answer == answers.end() ? std::nullopt : std::optional{answer->second};
}

Result<evod::v1::Response> Connection::wait_subscribed(SubscriptionHandle handle, std::chrono::milliseconds timeout) {
    const Received& received = io_->received();
    const auto lock =
        io_->wait(timeout, [&] { return received.answers.contains(handle) || received.status.state == State::Failed; });
    if (const auto answer = received.answers.find(handle); answer != received.answers.end()) {
        return answer->second;
    }
    if (received.status.state == State::Failed) {
        return Error{.kind = Error::Kind::NoConnection, .what = received.status.reason};
    }
    return Error{.kind = Error::Kind::Timeout,
                 .what = "no reply to the subscription within " + std::to_string(timeout.count()) + " ms"};
}

std::shared_ptr<const codec::ReceivedSnapshot> Connection::take_snapshot(SubscriptionHandle handle,
                                                                         std::uint32_t island) {
    const auto lock = io_->lock();
    const auto islands = io_->received().snapshots.find(handle);
    auto taken =
        islands == io_->received().snapshots.end() ? IslandSnapshots::node_type{} : islands->second.extract(island);
    return taken ? std::move(taken.mapped()) : nullptr;
}

std::vector<std::shared_ptr<const codec::ReceivedSnapshot>> Connection::take_snapshots(SubscriptionHandle handle) {
    std::vector<std::shared_ptr<const codec::ReceivedSnapshot>> taken;
    const auto lock = io_->lock();
    if (auto islands = io_->received().snapshots.extract(handle)) {
        for (auto& [island, snapshot] : islands.mapped()) {
            taken.push_back(std::move(snapshot));
        }
    }
    return taken;
}

std::vector<evod::v1::Event> Connection::take_events() {
    std::vector<evod::v1::Event> events;
    const auto lock = io_->lock();
    while (auto event = io_->received().events.pop()) {
        events.push_back(*std::move(event));
    }
    return events;
}

std::optional<evod::v1::Event> Connection::wait_event(std::chrono::milliseconds timeout) {
    Received& received = io_->received();
    const auto lock =
        io_->wait(timeout, [&] { return !received.events.empty() || received.status.state == State::Failed; });
    return received.events.pop();
}

} // namespace evod::core
