// Connection: a client's connection to a server. It connects, sends requests, receives events and snapshots, and reconnects
// after a loss.
//
//     core::Connection connection{{.server = *core::parse_endpoint("localhost"), .client_name = "my program"}};
//     if (const auto welcome = connection.wait_connected(); !welcome) … welcome.error().what …
//     evod::v1::Request request;
//     request.mutable_run()->set_generations(3);
//     const auto response = connection.request(request);   // blocks; or send(), which does not
//     if (!response)                    … no reply: response.error().what …
//     else if (!core::accepted(*response)) … refused: core::to_text(response->status()) …
//
// Idempotent: each request carries an increasing number and the random key of this connection. A request that was unanswered
// when the connection broke is sent again with the same number, and the server executes it once.
//
// Owner        its creator; the destructor closes the connection and ends its thread.
// Threads      its own thread does all input and output. Every function may be called from any thread.
// Bounded      requests beyond the server's limit on unanswered requests wait here. The newest Options::events_kept events are
//              kept; an EventsDropped reports the others. Of snapshots, the newest of each subscription and island is
//              kept, and the baseline of the next delta.
#pragma once

#include "evod/v1/session.pb.h"
#include "proto/codec/framing.h"
#include "proto/codec/snapshot_codec.h"

#include <boost/system/result.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::core {

struct Error {
    enum class Kind {
        Usage,        // the request cannot be sent: malformed address, longer than the server's limit
        NoConnection, // no server, or it refuses this client
        TokenNeeded,  // the server requires a valid token
        Timeout,      // no reply in time; a command may have been executed
        Closed,       // this Connection was destroyed
    };
    Kind kind = Kind::NoConnection;
    std::string what; // one sentence for a person, without a full stop
};

[[noreturn]] void throw_exception_from_error(const Error& error, const boost::source_location& where);

template <class T>
using Result = boost::system::result<T, Error>;

// ---- address ---------------------------------------------------------------------------------------------------

struct Endpoint {
    std::string host = "localhost"; // without brackets
    std::uint16_t port = codec::default_port;
    friend bool operator==(const Endpoint&, const Endpoint&) = default;
};

/// HOST, HOST:PORT, [IPV6] or [IPV6]:PORT; an IPv6 address without a port may stand without brackets.
Result<Endpoint> parse_endpoint(std::string_view text);

/// HOST:PORT, with brackets where they are needed.
std::string to_text(const Endpoint& endpoint);

// ---- replies ---------------------------------------------------------------------------------------------------

inline bool accepted(const evod::v1::Response& response) {
    return response.status().code() == evod::v1::CODE_UNSPECIFIED;
}

/// Whether the worlds wait for the server's disk.
inline bool worlds_wait(const evod::v1::Storage& storage) {
    return storage.state() == evod::v1::STORAGE_STATE_STALLED || storage.state() == evod::v1::STORAGE_STATE_BEHIND;
}

/// "INVALID_ARGUMENT: the message", then a line for each violation.
std::string to_text(const evod::v1::Status& status);

// ---- the connection --------------------------------------------------------------------------------------------

struct Options {
    Endpoint server{};
    std::string token = ""; // empty: none
    struct Tls {
        std::string ca = "";          // PEM file of the server's certificate authority; empty: those of the system
        std::string certificate = ""; // PEM file of the client's certificate, for servers that require one
        std::string key = "";         // PEM file
    };
    std::optional<Tls> tls = {};             // nullopt: without TLS
    std::string client_name = "evod client"; // at most 64 bytes
    std::string client_version = "";
    bool reconnect = true;
    std::chrono::milliseconds connect_timeout{5000}; // for the connection, and again for the Welcome
    std::chrono::milliseconds backoff_min{100};      // wait before the first new attempt; doubles each time
    std::chrono::milliseconds backoff_max{5000};
    std::size_t events_kept = 10'000;
};

enum class State {
    Connecting,
    Connected,
    Lost,   // no connection; will reconnect
    Failed, // will not reconnect: the server refuses this client, or reconnect is false
};

/// "connecting", "connected", …
const char* to_text(State state);

struct ConnectionStatus {
    State state = State::Connecting;
    std::string reason;                       // one sentence in Lost, Failed and Connecting after a loss; else empty
    bool token_needed = false;                // Failed: the server requires a (different) token
    std::optional<evod::v1::Status> refusal;  // the server's refusal, if that is the reason
    std::optional<evod::v1::Welcome> welcome; // of the last session
    std::uint64_t connected_count = 0;        // how often the state became Connected
    std::uint64_t damaged_snapshot_count = 0; // snapshots dropped because they could not be decoded
    std::string last_damage;                  // the error of the last one
    std::uint64_t keyframe_request_count = 0; // keyframes requested after damage
};

/// Names a subscription for as long as the Connection lives, across reconnections.
struct SubscriptionHandle {
    std::uint32_t number = 0; // not the server's subscription_id, which changes with each session
    friend bool operator==(const SubscriptionHandle&, const SubscriptionHandle&) = default;
    friend bool operator<(SubscriptionHandle a, SubscriptionHandle b) { return a.number < b.number; }
};

class Connection {
  public:
    using Handler = std::function<void(Result<evod::v1::Response>)>;
    static constexpr std::chrono::milliseconds default_timeout{10'000};
    /// Snapshots of an island that the server may send before the first is acknowledged: enough for 30 per second at a round
    /// trip of 0.25 s, which also bounds the backlog.
    static constexpr std::uint32_t unacknowledged_snapshots_max = 8;

    /// Starts to connect and returns immediately.
    explicit Connection(Options options);
    ~Connection();
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    ConnectionStatus status() const;

    /// Waits until connected and returns the server's Welcome, or until an attempt to connect has failed.
    Result<evod::v1::Welcome> wait_connected(std::chrono::milliseconds timeout = default_timeout);

    /// Sends a request and waits for its reply; sets request_id and client_key. Without a connection, waits for one.
    Result<evod::v1::Response> request(evod::v1::Request request, std::chrono::milliseconds timeout = default_timeout);

    /// Sends a request without waiting. Requests are sent in the order of the calls. The handler is called exactly once, on the
    /// connection's thread (or in the destructor, with Closed), and must not block.
    void send(evod::v1::Request request, Handler handler, std::chrono::milliseconds timeout = default_timeout);

    /// Sends a request without waiting; the caller polls the future.
    std::future<Result<evod::v1::Response>> send(evod::v1::Request request,
                                                 std::chrono::milliseconds timeout = default_timeout);

    /// Subscribes now or when connected, and again after each reconnection, until unsubscribe(). If no codec is set, the
    /// snapshots use the most compact codec of the server, and are acknowledged when they are decoded.
    SubscriptionHandle subscribe(evod::v1::SubscribeSnapshots subscription);
    SubscriptionHandle subscribe(evod::v1::SubscribeEvents subscription);
    /// Changes the view of a subscription that was made with one, now and after each reconnection. A server without the feature
    /// "view" continues to send whole snapshots.
    void set_view(SubscriptionHandle handle, evod::v1::View view);
    void unsubscribe(SubscriptionHandle handle);

    /// The server's last reply to a subscription (may be a refusal); nullopt: none yet in this session.
    std::optional<evod::v1::Response> subscription_answer(SubscriptionHandle handle) const;
    Result<evod::v1::Response> wait_subscribed(SubscriptionHandle handle,
                                               std::chrono::milliseconds timeout = default_timeout);

    /// Returns the newest snapshot of an island that was not taken yet; null if there is none. Its run_id and state_hash are
    /// hexadecimal digits, as in a WorldInfo.
    std::shared_ptr<const codec::DecodedSnapshot> take_snapshot(SubscriptionHandle handle, std::uint32_t island = 0);
    /// Returns the newest snapshot of every island that has one, in ascending order of islands.
    std::vector<std::shared_ptr<const codec::DecodedSnapshot>> take_snapshots(SubscriptionHandle handle);

    /// Returns all events since the last call, oldest first.
    std::vector<evod::v1::Event> take_events();
    /// Returns the next event; nullopt after `timeout`, or immediately if the state is Failed and none is left.
    std::optional<evod::v1::Event> wait_event(std::chrono::milliseconds timeout);

  private:
    class Io;
    std::unique_ptr<Io> io_;
};

} // namespace evod::core
