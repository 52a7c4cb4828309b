// Connection: a client's connection to a server. It connects, sends requests, receives events and snapshots, and
// reconnects after a loss.
//
//     core::Connection connection{{.server = *core::parse_endpoint("localhost"), .client_name = "my program"}};
//     if (const auto welcome = connection.wait_connected(); !welcome) … welcome.error().what …
//     evod::v1::Request request;
//     request.mutable_run()->set_generations(3);
//     const auto response = connection.request(request);   // blocks; or send(), which does not
//     if (!response)                    … no reply: response.error().what …
//     else if (!core::accepted(*response)) … refused: core::to_text(response->status()) …
//
// Idempotent: each request carries an increasing number and the random key of this object. If the TCP connection is
// lost before the reply arrives, the request is sent again with the same number. The server executes it only once.
//
// Owner        its creator; the destructor closes the connection and ends its thread.
// Threads      its own thread does all input and output. Every function may be called from any thread.
// Bounded      requests beyond the server's limit on unanswered requests wait here. This object keeps the newest
//              Options::events_kept events and reports older ones, which it drops, by an EventsDropped. For each
//              subscription and island it keeps the newest snapshot and the baseline for the next delta.
#pragma once

#include "client/core/client_types.h"

#include "proto/codec/snapshot_codec.h"

#include <future>
#include <memory>
#include <vector>

namespace evod::core {

class Connection {
  public:
    using Handler = core::Handler;
    static constexpr std::chrono::milliseconds default_timeout{10'000};
    /// The server sends at most this many snapshots of an island without an acknowledgement, which bounds the backlog.
    /// A limit of 8 allows 30 snapshots per second with a round-trip time of 0.25 s.
    static constexpr std::uint32_t unacknowledged_snapshots_max = 8;

    /// Starts connecting and returns immediately.
    explicit Connection(Options options);
    ~Connection();
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    ConnectionStatus status() const;

    /// Waits until connected and returns the server's Welcome, or until an attempt to connect has failed.
    Result<evod::v1::Welcome> wait_connected(std::chrono::milliseconds timeout = default_timeout);

    /// Sends a request and waits for its reply; sets request_id and client_key. If there is no connection, waits for
    /// one.
    Result<evod::v1::Response> request(evod::v1::Request request, std::chrono::milliseconds timeout = default_timeout);

    /// Sends a request and returns immediately. Requests are sent in the order of the calls. The handler is called
    /// exactly once: on the connection's thread, or by the destructor with the error Closed. The handler must not
    /// block.
    void send(evod::v1::Request request, Handler handler, std::chrono::milliseconds timeout = default_timeout);

    /// Sends a request and returns immediately; the future receives the reply.
    std::future<Result<evod::v1::Response>> send(evod::v1::Request request,
                                                 std::chrono::milliseconds timeout = default_timeout);

    /// Subscribes as soon as there is a connection, and again after each reconnection, until unsubscribe() is called.
    /// If no codec is set, requests the server's most compact codec and acknowledges each snapshot when it is decoded.
    SubscriptionHandle subscribe(evod::v1::SubscribeSnapshots subscription);
    SubscriptionHandle subscribe(evod::v1::SubscribeEvents subscription);
    /// Sets the view of a subscription. Sets it again after each reconnection. The subscription must have been created
    /// with a view. A server without the feature "view" continues to send whole snapshots.
    void set_view(SubscriptionHandle handle, evod::v1::View view);
    void unsubscribe(SubscriptionHandle handle);

    /// Returns the server's last reply to the subscription request, which may be a refusal; nullopt: no reply yet in
    /// this session.
    std::optional<evod::v1::Response> subscription_answer(SubscriptionHandle handle) const;
    Result<evod::v1::Response> wait_subscribed(SubscriptionHandle handle,
                                               std::chrono::milliseconds timeout = default_timeout);

    /// Returns the newest snapshot of an island; null if there is none, or if it was already taken. Its run_id and
    /// state_hash are hexadecimal digits, as in a WorldInfo.
    std::shared_ptr<const codec::ReceivedSnapshot> take_snapshot(SubscriptionHandle handle, std::uint32_t island = 0);
    /// Returns the newest snapshot of each island, in ascending order of islands; omits islands without a new one.
    std::vector<std::shared_ptr<const codec::ReceivedSnapshot>> take_snapshots(SubscriptionHandle handle);

    /// Returns all events since the last call, oldest first.
    std::vector<evod::v1::Event> take_events();
    /// Waits for the next event and returns it. Returns nullopt if no event arrived within `timeout`, or if the state
    /// is Failed and no event is left.
    std::optional<evod::v1::Event> wait_event(std::chrono::milliseconds timeout);

  private:
    class Io;
    std::unique_ptr<Io> io_;
};

} // namespace evod::core
