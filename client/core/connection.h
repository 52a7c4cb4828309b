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
        Usage,        // the address is malformed, or the request is longer than the server allows
        NoConnection, // no server answers, or the server refuses this client
        TokenNeeded,  // the server requires a valid token
        Timeout,      // no reply arrived in time; the server may have executed the command
        Closed,       // this Connection was destroyed
    };
    Kind kind = Kind::NoConnection;
    std::string what; // one sentence for the user, without a full stop
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

/// Parses HOST, HOST:PORT, [IPV6] or [IPV6]:PORT. An IPv6 address without a port needs no brackets.
Result<Endpoint> parse_endpoint(std::string_view text);

/// Returns HOST:PORT, or [IPV6]:PORT for an IPv6 address.
std::string to_text(const Endpoint& endpoint);

// ---- replies ---------------------------------------------------------------------------------------------------

inline bool accepted(const evod::v1::Response& response) {
    return response.status().code() == evod::v1::CODE_UNSPECIFIED;
}

/// Returns whether the worlds are waiting for the server's disk.
inline bool worlds_wait(const evod::v1::Storage& storage) {
    return storage.state() == evod::v1::STORAGE_STATE_STALLED || storage.state() == evod::v1::STORAGE_STATE_BEHIND;
}

/// Returns "INVALID_ARGUMENT: the message", followed by one line for each violation.
std::string to_text(const evod::v1::Status& status);

// ---- the connection --------------------------------------------------------------------------------------------

struct Options {
    Endpoint server{};
    std::string token = ""; // empty: none
    struct Tls {
        std::string ca = "";          // PEM file with trusted certificates; empty: those that the system trusts
        std::string certificate = ""; // PEM file with the client's certificate, for servers that require one
        std::string key = "";         // PEM file with the private key for the client's certificate
    };
    std::optional<Tls> tls = {};             // nullopt: without TLS
    std::string client_name = "evod client"; // at most 64 bytes
    std::string client_version = "";
    bool reconnect = true;
    std::chrono::milliseconds connect_timeout{5000}; // for connecting, and again for receiving the Welcome
    std::chrono::milliseconds backoff_min{100};      // wait before the first attempt to reconnect; doubles each time
    std::chrono::milliseconds backoff_max{5000};
    std::size_t events_kept = 10'000;
};

enum class State {
    Connecting,
    Connected,
    Lost,   // no connection; will reconnect
    Failed, // will not reconnect: the server refuses this client, or Options::reconnect is false
};

/// Returns the state in lower case: "connecting", "connected", …
const char* to_text(State state);

struct ConnectionStatus {
    State state = State::Connecting;
    std::string reason;                       // why there is no connection, in one sentence; empty if none was lost
    bool token_needed = false;                // the state is Failed because the server requires a (different) token
    std::optional<evod::v1::Status> refusal;  // the server's refusal, if the server refused this client
    std::optional<evod::v1::Welcome> welcome; // received in the last session
    std::uint64_t connected_count = 0;        // how often the state became Connected
    std::uint64_t damaged_snapshot_count = 0; // snapshots dropped because they could not be decoded
    std::string last_damage;                  // the decoding error of the last damaged snapshot
    std::uint64_t keyframe_request_count = 0; // keyframes requested because a snapshot was damaged
};

/// Identifies a subscription for the lifetime of the Connection; stays valid after a reconnection.
struct SubscriptionHandle {
    std::uint32_t number = 0; // not the server's subscription_id, which changes with each session
    friend bool operator==(const SubscriptionHandle&, const SubscriptionHandle&) = default;
    friend bool operator<(SubscriptionHandle a, SubscriptionHandle b) { return a.number < b.number; }
};

class Connection {
  public:
    using Handler = std::function<void(Result<evod::v1::Response>)>;
    static constexpr std::chrono::milliseconds default_timeout{10'000};
    /// The server sends at most this many snapshots of an island without an acknowledgement, which bounds the backlog.
    /// 8 allow 30 snapshots per second with a round-trip time of 0.25 s.
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
    /// Changes the view now and after each reconnection. The subscription must have been created with a view. A server
    /// without the feature "view" continues to send whole snapshots.
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
    /// Waits for the next event and returns it. nullopt: none arrived within `timeout`, or the state is Failed and no
    /// event is left.
    std::optional<evod::v1::Event> wait_event(std::chrono::milliseconds timeout);

  private:
    class Io;
    std::unique_ptr<Io> io_;
};

} // namespace evod::core
