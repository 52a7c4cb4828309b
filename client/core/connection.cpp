#include "client/core/connection.h"

#include "client/core/session.h"

#include "proto/codec/snapshot_decoder.h"

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/throw_exception.hpp>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

namespace evod::core {

namespace asio = boost::asio;

void throw_exception_from_error(const Error& error, const boost::source_location& where) {
    boost::throw_exception(std::runtime_error{error.what}, where);
}

const char* to_text(State state) {
    switch (state) {
    case State::Connecting:
        return "connecting";
    case State::Connected:
        return "connected";
    case State::Lost:
        return "lost";
    case State::Failed:
        return "failed";
    }
    return "unknown";
}

std::string to_text(const evod::v1::Status& status) {
    std::string name = evod::v1::Code_IsValid(status.code()) ? evod::v1::Code_Name(status.code()) : "CODE_UNKNOWN";
    std::string text = name.substr(std::string{"CODE_"}.size());
    if (!status.message().empty()) {
        text += ": " + status.message();
    }
    for (const auto& violation : status.violations()) {
        text += "\n  " + violation.field() + ": got " + violation.got() + ", allowed " + violation.allowed();
    }
    return text;
}

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

std::string hexadecimal(std::string_view bytes) {
    std::string digits;
    digits.reserve(2 * bytes.size());
    for (const char byte : bytes) {
        digits += "0123456789abcdef"[static_cast<unsigned char>(byte) >> 4];
        digits += "0123456789abcdef"[byte & 15];
    }
    return digits;
}

} // namespace

/// The connection's thread, and the state and functions that belong to it.
class Connection::Io {
  public:
    explicit Io(Options options) : options_{std::move(options)} {
        thread_ = std::thread{[this] {
            begin_session();
            context_.run();
        }};
    }

    ~Io() {
        asio::post(context_, [this] { shut_down(); });
        thread_.join();
    }

    // ---- functions for any thread ------------------------------------------------------------------------------

    ConnectionStatus status() const {
        const std::lock_guard lock{mutex_};
        return status_;
    }

    bool on_own_thread() const { return std::this_thread::get_id() == thread_.get_id(); }

    /// Waits until `holds(*this)` returns true. The mutex is locked while `holds` runs.
    template <class Condition>
    bool wait(std::chrono::milliseconds timeout, const Condition& holds) {
        std::unique_lock lock{mutex_};
        return changed_.wait_for(lock, timeout, holds);
    }

    void post_request(evod::v1::Request request, Handler handler, std::chrono::milliseconds timeout) {
        asio::post(context_, [this, request = std::move(request), handler = std::move(handler), timeout]() mutable {
            add_request(std::move(request), std::move(handler), timeout);
        });
    }

    SubscriptionHandle post_subscription(evod::v1::Request request) {
        const SubscriptionHandle handle{++last_handle_};
        asio::post(context_, [this, handle, request = std::move(request)]() mutable {
            subscriptions_[handle].request = std::move(request);
            ask_for_subscription(handle, Order::InTurn);
        });
        return handle;
    }

    void post_view(SubscriptionHandle handle, evod::v1::View view) {
        asio::post(context_, [this, handle, view = std::move(view)]() mutable {
            const auto entry = subscriptions_.find(handle);
            if (entry == subscriptions_.end() || !entry->second.request.has_subscribe_snapshots()) {
                return;
            }
            *entry->second.request.mutable_subscribe_snapshots()->mutable_view() = std::move(view);
            entry->second.view_changed = true;
            send_view(entry->second);
        });
    }

    void post_unsubscribe(SubscriptionHandle handle) {
        asio::post(context_, [this, handle] { remove_subscription(handle); });
    }

    // ---- shared state, guarded by the mutex --------------------------------------------------------------------

    mutable std::mutex mutex_; // guards all members up to the next section
    std::condition_variable changed_;
    ConnectionStatus status_;
    std::deque<evod::v1::Event> events_;
    std::uint64_t events_dropped_ = 0;
    std::map<SubscriptionHandle, evod::v1::Response> answers_;
    std::map<SubscriptionHandle, std::map<std::uint32_t, std::shared_ptr<const codec::ReceivedSnapshot>>> snapshots_;

    /// Removes and returns the oldest event. If events were lost, first returns an EventsDropped. The caller holds the
    /// mutex.
    std::optional<evod::v1::Event> pop_event() {
        evod::v1::Event event;
        if (events_dropped_ > 0) {
            event.mutable_events_dropped()->set_dropped_count(std::exchange(events_dropped_, 0));
        } else if (!events_.empty()) {
            event = std::move(events_.front());
            events_.pop_front();
        } else {
            return std::nullopt;
        }
        return event;
    }

  private:
    /// The treatment of a request that is still unanswered when the session ends.
    enum class Loss {
        SentAgain, // it is sent again with the same number
        Renewed,   // a subscription: dropped if it was sent, because every new session requests all subscriptions
        Forgotten, // it is dropped, because it has no meaning outside its session
    };
    enum class Order { InTurn, First };

    /// A request without a reply.
    struct Pending {
        std::string frame;
        Handler handler;
        asio::steady_timer deadline;
        Loss loss;
        Order order;
        bool sent = false; // whether it was sent in this session
    };

    struct ActiveSubscription {
        evod::v1::Request request;
        bool asked = false;                     // the request to subscribe is pending
        bool view_changed = false;              // the view was changed after the last request that contained it
        std::optional<std::uint32_t> server_id; // its id in this session; nullopt: the server has not accepted it yet
    };

    bool connected() const { return session_ && welcomed_; }

    template <class Change>
    void share(const Change& change) {
        {
            const std::lock_guard lock{mutex_};
            change();
        }
        changed_.notify_all();
    }

    // ---- sessions ----------------------------------------------------------------------------------------------

    void begin_session() {
        share([&] { status_.state = State::Connecting; });
        session_ = std::make_shared<Session>(
            context_, options_,
            Session::Handlers{
                .welcomed = [this](evod::v1::Welcome welcome) { on_welcome(std::move(welcome)); },
                .received = [this](evod::v1::ServerMessage message) { on_message(std::move(message)); },
                .snapshot_received = [this](evod::v1::SnapshotFrame frame) { on_snapshot(std::move(frame)); },
                .ended = [this](Session::Ending ending) { on_end(std::move(ending)); }});
        session_->start();
    }

    void on_welcome(evod::v1::Welcome welcome) {
        limits_ = welcome.limits();
        backoff_ = options_.backoff_min;
        share([&] {
            status_.state = State::Connected;
            status_.reason.clear();
            status_.refusal.reset();
            status_.welcome = std::move(welcome);
            ++status_.connected_count;
        });
        // Subscriptions are sent first, so that the caller receives the events that its requests cause.
        for (const auto& [handle, subscription] : subscriptions_) {
            if (!subscription.asked) {
                ask_for_subscription(handle, Order::First);
            }
        }
        welcomed_ = true;
        send_waiting();
    }

    void on_end(Session::Ending ending) {
        session_.reset();
        welcomed_ = false;
        in_flight_count_ = 0;
        late_.clear();
        handle_of_server_id_.clear();
        streams_.clear();
        for (auto& [handle, subscription] : subscriptions_) {
            subscription.server_id.reset();
        }
        const bool again = options_.reconnect && !ending.final;
        if (!again) {
            failed_ = ending.reason;
        }
        share([&] {
            status_.state = again ? State::Lost : State::Failed;
            status_.reason = ending.reason;
            status_.token_needed = ending.token_needed;
            status_.refusal = ending.refusal;
            answers_.clear();
        });
        std::vector<Handler> given_up;
        for (auto entry = pending_.begin(); entry != pending_.end();) {
            const bool was_sent = std::exchange(entry->second.sent, false);
            const Loss loss = entry->second.loss;
            if (!again || loss == Loss::Forgotten || (loss == Loss::Renewed && was_sent)) {
                given_up.push_back(std::move(entry->second.handler));
                entry = pending_.erase(entry);
            } else {
                ++entry;
            }
        }
        for (const Handler& handler : given_up) {
            handler(Error{.kind = Error::Kind::NoConnection, .what = ending.reason});
        }
        if (again) {
            // Jitter, so that the clients of a server do not all reconnect at the same moment.
            const auto spread = std::uniform_real_distribution{0.5, 1.0}(jitter_);
            retry_.expires_after(std::chrono::duration_cast<std::chrono::milliseconds>(backoff_ * spread));
            backoff_ = std::min(2 * backoff_, options_.backoff_max);
            retry_.async_wait([this](const boost::system::error_code& error) {
                if (!error && !closing_) {
                    begin_session();
                }
            });
        }
    }

    void shut_down() {
        closing_ = true;
        retry_.cancel();
        if (session_) {
            session_->close();
            session_.reset();
        }
        for (auto& [id, pending] : std::exchange(pending_, {})) {
            pending.handler(closed());
        }
        guard_.reset();
    }

    static Error closed() { return {.kind = Error::Kind::Closed, .what = "the connection was closed by this program"}; }

    // ---- requests ----------------------------------------------------------------------------------------------

    void add_request(evod::v1::Request request, Handler handler, std::chrono::milliseconds timeout,
                     Loss loss = Loss::SentAgain, Order order = Order::InTurn) {
        if (closing_) {
            handler(closed());
            return;
        }
        if (failed_) {
            handler(Error{.kind = Error::Kind::NoConnection, .what = *failed_});
            return;
        }
        const std::uint64_t id = ++last_request_id_;
        request.set_request_id(id);
        request.set_client_key(client_key_);
        evod::v1::ClientMessage message;
        *message.mutable_request() = std::move(request);
        const std::uint32_t limit = limits_.control_frame_bytes_max() > 0 ? limits_.control_frame_bytes_max()
                                                                          : *codec::server_limits.control_bytes_max;
        if (message.ByteSizeLong() > limit) {
            handler(Error{.kind = Error::Kind::Usage,
                          .what = "the request is " + std::to_string(message.ByteSizeLong()) + " bytes long, allowed " +
                                  std::to_string(limit)});
            return;
        }
        const auto entry = pending_
                               .emplace(id, Pending{.frame = codec::encode_frame(codec::Channel::Control, message),
                                                    .handler = std::move(handler),
                                                    .deadline = asio::steady_timer{context_},
                                                    .loss = loss,
                                                    .order = order})
                               .first;
        entry->second.deadline.expires_after(timeout);
        entry->second.deadline.async_wait([this, id, timeout](const boost::system::error_code& error) {
            if (!error) {
                give_up(id, timeout);
            }
        });
        send_waiting();
    }

    /// Sends waiting requests until the server's limit on unanswered requests is reached.
    void send_waiting() {
        if (!connected()) {
            return;
        }
        const std::size_t most = limits_.requests_in_flight_max() > 0 ? limits_.requests_in_flight_max() : 64;
        for (const Order order : {Order::First, Order::InTurn}) {
            for (auto& [id, pending] : pending_) {
                if (in_flight_count_ >= most) {
                    return;
                }
                if (!pending.sent && pending.order == order) {
                    pending.sent = true;
                    ++in_flight_count_;
                    session_->send(pending.frame);
                }
            }
        }
    }

    void give_up(std::uint64_t id, std::chrono::milliseconds timeout) {
        const auto entry = pending_.find(id);
        if (entry == pending_.end()) {
            return;
        }
        // A request that was sent counts towards the server's limit until its reply arrives, even after the timeout.
        // That late reply is dropped.
        if (entry->second.sent) {
            late_.insert(id);
        }
        const Handler handler = std::move(entry->second.handler);
        pending_.erase(entry);
        const auto status = this->status();
        std::string what = "no reply within " + std::to_string(timeout.count()) + " ms";
        if (status.state != State::Connected && !status.reason.empty()) {
            what += ": " + status.reason;
        }
        handler(Error{.kind = Error::Kind::Timeout, .what = std::move(what)});
    }

    void on_response(evod::v1::Response response) {
        const auto entry = pending_.find(response.request_id());
        if (late_.erase(response.request_id()) > 0) {
            --in_flight_count_;
        } else if (entry != pending_.end() && entry->second.sent) {
            --in_flight_count_;
            const Handler handler = std::move(entry->second.handler);
            pending_.erase(entry);
            handler(std::move(response));
        }
        send_waiting();
    }

    // ---- subscriptions, events, snapshots ----------------------------------------------------------------------

    void ask_for_subscription(SubscriptionHandle handle, Order order) {
        auto& subscription = subscriptions_[handle];
        subscription.asked = true;
        subscription.view_changed = false;
        const auto answered = [this, handle](Result<evod::v1::Response> response) {
            const auto entry = subscriptions_.find(handle);
            if (entry != subscriptions_.end()) {
                entry->second.asked = false;
            }
            if (!response) {
                return; // the session has ended; the next session subscribes again
            }
            const std::uint32_t server_id = response->subscription().subscription_id();
            if (entry == subscriptions_.end()) {
                unsubscribe_from(server_id);
                return;
            }
            if (accepted(*response)) {
                entry->second.server_id = server_id;
                handle_of_server_id_[server_id] = handle;
                send_view(entry->second);
            }
            share([&] { answers_[handle] = *std::move(response); });
        };
        add_request(subscription.request, answered, std::chrono::hours{24 * 365}, Loss::Renewed, order);
    }

    /// Sends the view if it was changed after the subscription was requested.
    void send_view(ActiveSubscription& subscription) {
        if (!subscription.view_changed || !subscription.server_id || !connected()) {
            return;
        }
        subscription.view_changed = false;
        evod::v1::Request request;
        request.mutable_set_view()->set_subscription_id(*subscription.server_id);
        *request.mutable_set_view()->mutable_view() = subscription.request.subscribe_snapshots().view();
        add_request(
            std::move(request), [](const auto&) {}, default_timeout, Loss::Forgotten, Order::First);
    }

    void remove_subscription(SubscriptionHandle handle) {
        const auto entry = subscriptions_.find(handle);
        if (entry == subscriptions_.end()) {
            return;
        }
        const auto server_id = entry->second.server_id;
        subscriptions_.erase(entry);
        share([&] {
            answers_.erase(handle);
            snapshots_.erase(handle);
        });
        if (server_id) {
            unsubscribe_from(*server_id);
        }
    }

    void unsubscribe_from(std::uint32_t server_id) {
        if (connected() && server_id > 0) {
            handle_of_server_id_.erase(server_id);
            streams_.erase(server_id);
            evod::v1::Request request;
            request.mutable_unsubscribe()->set_subscription_id(server_id);
            add_request(
                std::move(request), [](const auto&) {}, default_timeout, Loss::Forgotten);
        }
    }

    void on_message(evod::v1::ServerMessage message) {
        if (message.has_response()) {
            on_response(std::move(*message.mutable_response()));
        } else if (message.has_event()) {
            share([&] {
                events_.push_back(std::move(*message.mutable_event()));
                if (events_.size() > std::max<std::size_t>(options_.events_kept, 1)) {
                    events_.pop_front();
                    ++events_dropped_;
                }
            });
        }
    }

    void on_snapshot(evod::v1::SnapshotFrame frame) {
        const std::uint32_t server_id = frame.subscription_id();
        const auto known = handle_of_server_id_.find(server_id);
        if (known == handle_of_server_id_.end()) {
            return; // the caller has unsubscribed since
        }
        const SubscriptionHandle handle = known->second;
        if (subscriptions_.at(handle).request.subscribe_snapshots().has_unacknowledged_max()) {
            acknowledge(frame);
        }
        IslandStream& stream = streams_[server_id][frame.island()];
        const bool chained = frame.codec() == evod::v1::CODEC_DELTA;
        if (chained && !codec::is_keyframe(frame) && stream.decoder.needs_keyframe() && stream.keyframe_requests > 0) {
            return; // the server sent this delta before the requested keyframe
        }
        auto decoded = stream.decoder.decode(std::move(frame));
        if (!decoded) {
            // If keyframes are damaged too, requesting more of them does not help.
            const bool ask = chained && stream.keyframe_requests < keyframe_requests_max;
            share([&] {
                ++status_.damaged_snapshot_count;
                status_.last_damage = decoded.error().what;
                status_.keyframe_request_count += ask ? 1 : 0;
            });
            if (ask) {
                ++stream.keyframe_requests;
                request_keyframe(server_id);
            }
            return;
        }
        stream.keyframe_requests = 0;
        // The same format as in WorldInfo and Event, so that the values can be compared.
        decoded->about.set_run_id(hexadecimal(decoded->about.run_id()));
        decoded->about.set_state_hash(hexadecimal(decoded->about.state_hash()));
        share([&] {
            const std::uint32_t island = decoded->about.island();
            snapshots_[handle][island] = std::make_shared<const codec::ReceivedSnapshot>(*std::move(decoded));
        });
    }

    /// Acknowledges a snapshot that has a number. Servers without acknowledgements do not number their snapshots.
    void acknowledge(const evod::v1::SnapshotFrame& frame) {
        if (frame.sequence() == 0) {
            return;
        }
        evod::v1::ClientMessage message;
        auto& acknowledged = *message.mutable_acknowledge_snapshot();
        acknowledged.set_subscription_id(frame.subscription_id());
        acknowledged.set_island(frame.island());
        acknowledged.set_sequence(frame.sequence());
        session_->send(codec::encode_frame(codec::Channel::Control, message));
    }

    void request_keyframe(std::uint32_t server_id) {
        evod::v1::Request request;
        request.mutable_request_keyframe()->set_subscription_id(server_id);
        add_request(
            std::move(request), [](const auto&) {}, default_timeout, Loss::Forgotten, Order::First);
    }

    /// The snapshot stream for one subscription and one island, in this session.
    struct IslandStream {
        codec::SnapshotDecoder decoder;
        int keyframe_requests = 0; // number of keyframe requests since the last decoded snapshot
    };
    static constexpr int keyframe_requests_max = 3;

    const Options options_;
    const std::string client_key_ = random_key();
    std::atomic<std::uint32_t> last_handle_ = 0;

    // Used only on the connection's thread.
    asio::io_context context_{1};
    asio::executor_work_guard<asio::io_context::executor_type> guard_{context_.get_executor()};
    asio::steady_timer retry_{context_};
    std::shared_ptr<Session> session_;
    bool welcomed_ = false, closing_ = false;
    std::optional<std::string> failed_; // why this client will not reconnect; nullopt: it will
    evod::v1::Limits limits_;
    std::chrono::milliseconds backoff_ = options_.backoff_min;
    std::minstd_rand jitter_{std::random_device{}()};
    std::uint64_t last_request_id_ = 0;
    std::map<std::uint64_t, Pending> pending_; // by request_id
    std::size_t in_flight_count_ = 0;          // requests that were sent in this session and have no reply
    std::set<std::uint64_t> late_;             // ids of requests in flight whose callers no longer wait
    std::map<SubscriptionHandle, ActiveSubscription> subscriptions_;
    std::map<std::uint32_t, SubscriptionHandle> handle_of_server_id_;
    std::map<std::uint32_t, std::map<std::uint32_t, IslandStream>> streams_; // by server_id and island

    std::thread thread_; // the last member, because the thread uses all others
};

Connection::Connection(Options options) : io_{std::make_unique<Io>(std::move(options))} {}

Connection::~Connection() = default;

ConnectionStatus Connection::status() const {
    return io_->status();
}

Result<evod::v1::Welcome> Connection::wait_connected(std::chrono::milliseconds timeout) {
    io_->wait(timeout, [&] { return io_->status_.state != State::Connecting; });
    const ConnectionStatus status = io_->status();
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
    io_->post_request(std::move(request), std::move(handler), timeout);
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
    }
    *request.mutable_subscribe_snapshots() = std::move(subscription);
    return io_->post_subscription(std::move(request));
}

SubscriptionHandle Connection::subscribe(evod::v1::SubscribeEvents subscription) {
    evod::v1::Request request;
    *request.mutable_subscribe_events() = std::move(subscription);
    return io_->post_subscription(std::move(request));
}

void Connection::set_view(SubscriptionHandle handle, evod::v1::View view) {
    io_->post_view(handle, std::move(view));
}

void Connection::unsubscribe(SubscriptionHandle handle) {
    io_->post_unsubscribe(handle);
}

std::optional<evod::v1::Response> Connection::subscription_answer(SubscriptionHandle handle) const {
    const std::lock_guard lock{io_->mutex_};
    const auto answer = io_->answers_.find(handle);
    return answer == io_->answers_.end() ? std::nullopt : std::optional{answer->second};
}

Result<evod::v1::Response> Connection::wait_subscribed(SubscriptionHandle handle, std::chrono::milliseconds timeout) {
    io_->wait(timeout, [&] { return io_->answers_.contains(handle) || io_->status_.state == State::Failed; });
    if (auto answer = subscription_answer(handle)) {
        return *std::move(answer);
    }
    const ConnectionStatus status = io_->status();
    if (status.state == State::Failed) {
        return Error{.kind = Error::Kind::NoConnection, .what = status.reason};
    }
    return Error{.kind = Error::Kind::Timeout,
                 .what = "no reply to the subscription within " + std::to_string(timeout.count()) + " ms"};
}

std::shared_ptr<const codec::ReceivedSnapshot> Connection::take_snapshot(SubscriptionHandle handle,
                                                                         std::uint32_t island) {
    const std::lock_guard lock{io_->mutex_};
    const auto islands = io_->snapshots_.find(handle);
    if (islands == io_->snapshots_.end()) {
        return nullptr;
    }
    const auto newest = islands->second.find(island);
    return newest == islands->second.end() ? nullptr : islands->second.extract(newest).mapped();
}

std::vector<std::shared_ptr<const codec::ReceivedSnapshot>> Connection::take_snapshots(SubscriptionHandle handle) {
    std::vector<std::shared_ptr<const codec::ReceivedSnapshot>> taken;
    const std::lock_guard lock{io_->mutex_};
    if (const auto islands = io_->snapshots_.find(handle); islands != io_->snapshots_.end()) {
        for (auto& [island, snapshot] : std::exchange(islands->second, {})) {
            taken.push_back(std::move(snapshot));
        }
    }
    return taken;
}

std::vector<evod::v1::Event> Connection::take_events() {
    std::vector<evod::v1::Event> events;
    const std::lock_guard lock{io_->mutex_};
    while (auto event = io_->pop_event()) {
        events.push_back(*std::move(event));
    }
    return events;
}

std::optional<evod::v1::Event> Connection::wait_event(std::chrono::milliseconds timeout) {
    io_->wait(timeout,
              [&] { return !io_->events_.empty() || io_->events_dropped_ > 0 || io_->status_.state == State::Failed; });
    const std::lock_guard lock{io_->mutex_};
    return io_->pop_event();
}

} // namespace evod::core
