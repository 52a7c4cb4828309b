// Connection: a client's line to a server. It connects, says hello, sends requests, receives events and pictures, and
// when the line breaks it connects again and carries on.
//
//     core::Connection connection{{.server = *core::parse_endpoint("localhost"), .client_name = "my program"}};
//     if (const auto welcome = connection.wait_connected(); !welcome) … welcome.error().what …
//     evod::v1::Request request;
//     request.mutable_run()->set_generations(3);
//     const auto response = connection.request(request);   // blocks; or send(), which does not
//     if (!response)                    … nothing was heard: response.error().what …
//     else if (!core::accepted(*response)) … the server said no: core::to_text(response->status()) …
//
// Safe to repeat: requests carry a number that rises and a key drawn for this connection, so a request that was under
// way when the line broke is sent again, with the same number, and a command happens once.
//
// Owner        whoever makes it; its destructor closes the line and ends its thread.
// Threads      one of its own does all input and output. Every function may be called from any thread.
// Bounded      requests beyond the server's limit wait here for their turn; of events the newest
//              Options::events_kept are kept and the loss is told in an EventsDropped; of pictures the newest of each
//              subscription and island, and what the next delta is told from.
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
        Usage,        // what was asked cannot be sent: a malformed address, a request over the server's limit
        NoConnection, // no server there, or it does not speak with us
        TokenNeeded,  // it does, with whoever has a token it knows
        Timeout,      // no answer in time; a command may have been done all the same
        Closed,       // this Connection was destroyed
    };
    Kind kind = Kind::NoConnection;
    std::string what; // one sentence for a person, without a full stop
};

[[noreturn]] void throw_exception_from_error(const Error& error, const boost::source_location& where);

template <class T>
using Result = boost::system::result<T, Error>;

// ---- where -----------------------------------------------------------------------------------------------------

struct Endpoint {
    std::string host = "localhost"; // without brackets
    std::uint16_t port = codec::default_port;
    friend bool operator==(const Endpoint&, const Endpoint&) = default;
};

/// HOST, HOST:PORT, [IPV6] or [IPV6]:PORT; an IPv6 address without a port may stand without brackets.
Result<Endpoint> parse_endpoint(std::string_view text);

/// HOST:PORT, with brackets where they are needed.
std::string to_text(const Endpoint& endpoint);

// ---- answers ---------------------------------------------------------------------------------------------------

inline bool accepted(const evod::v1::Response& response) {
    return response.status().code() == evod::v1::CODE_UNSPECIFIED;
}

/// Whether worlds that live wait for the server's disk.
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
        std::string ca = "";          // PEM file of who vouches for the server; empty: those that the system trusts
        std::string certificate = ""; // PEM file of our own, for servers that ask for one
        std::string key = "";         // PEM file
    };
    std::optional<Tls> tls = {};             // nullopt: in the clear
    std::string client_name = "evod client"; // at most 64 bytes
    std::string client_version = "";
    bool reconnect = true;
    std::chrono::milliseconds connect_timeout{5000}; // for connecting, and again for the welcome
    std::chrono::milliseconds backoff_min{100};      // wait before the first new attempt; doubles each time
    std::chrono::milliseconds backoff_max{5000};
    std::size_t events_kept = 10'000;
};

enum class State {
    Connecting,
    Connected,
    Lost,   // broken or not there; will try again
    Failed, // will not try again: the server does not want us, or reconnect is off
};

/// "connecting", "connected", …
const char* to_text(State state);

struct ConnectionStatus {
    State state = State::Connecting;
    std::string reason;                       // Lost, Failed and Connecting after a loss: why, one sentence; else empty
    bool token_needed = false;                // Failed: the server wants a token, or another one
    std::optional<evod::v1::Status> refusal;  // what the server said, where that is the reason
    std::optional<evod::v1::Welcome> welcome; // of the last server we were connected with
    std::uint64_t connected_count = 0;        // times that Connected was reached
    std::uint64_t damaged_snapshot_count = 0; // pictures thrown away because they could not be decoded
    std::string last_damage;                  // what was wrong with the last of them
    std::uint64_t keyframe_request_count = 0; // keyframes asked for because of that
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
    /// A server sends so many pictures of an island ahead of their acknowledgement: enough for 30 a second over a line
    /// with a quarter of a second there and back, and a backlog of no more than that.
    static constexpr std::uint32_t unacknowledged_snapshots_max = 8;

    /// Begins to connect, and returns at once.
    explicit Connection(Options options);
    ~Connection();
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    ConnectionStatus status() const;

    /// Waits until connected, and gives the server's welcome; or until an attempt to connect has failed.
    Result<evod::v1::Welcome> wait_connected(std::chrono::milliseconds timeout = default_timeout);

    /// Sends a request, whose request_id and client_key are set here, and waits for its answer. While there is no
    /// connection it waits for one.
    Result<evod::v1::Response> request(evod::v1::Request request, std::chrono::milliseconds timeout = default_timeout);

    /// The same without waiting. Requests are sent in the order of these calls. The handler is called exactly once, on
    /// the connection's thread (or in the destructor, with Closed), and must not block.
    void send(evod::v1::Request request, Handler handler, std::chrono::milliseconds timeout = default_timeout);

    /// The same, for who would rather look now and then than be called.
    std::future<Result<evod::v1::Response>> send(evod::v1::Request request,
                                                 std::chrono::milliseconds timeout = default_timeout);

    /// Subscribes now or when connected, and again after each reconnection, until unsubscribe(). Pictures for which no
    /// codec is chosen come in the fewest bytes that the server has, and are acknowledged as they are decoded.
    SubscriptionHandle subscribe(evod::v1::SubscribeSnapshots subscription);
    SubscriptionHandle subscribe(evod::v1::SubscribeEvents subscription);
    /// Another view for a subscription to pictures that was made with one, now and after each reconnection. A server
    /// without the feature "view" sends whole pictures as before.
    void set_view(SubscriptionHandle handle, evod::v1::View view);
    void unsubscribe(SubscriptionHandle handle);

    /// The server's last answer to a subscription (it may be a refusal); nullopt: none has come yet in this session.
    std::optional<evod::v1::Response> subscription_answer(SubscriptionHandle handle) const;
    Result<evod::v1::Response> wait_subscribed(SubscriptionHandle handle,
                                               std::chrono::milliseconds timeout = default_timeout);

    /// The newest picture of an island that was not taken yet; null if there is none. Its run_id and state_hash are
    /// hexadecimal digits, as those of a WorldInfo.
    std::shared_ptr<const codec::DecodedSnapshot> take_snapshot(SubscriptionHandle handle, std::uint32_t island = 0);
    /// The newest of every island that has one, islands rising.
    std::vector<std::shared_ptr<const codec::DecodedSnapshot>> take_snapshots(SubscriptionHandle handle);

    /// All events since the last call, oldest first.
    std::vector<evod::v1::Event> take_events();
    /// The next event; nullopt after `timeout`, or at once when the state is Failed and none is left.
    std::optional<evod::v1::Event> wait_event(std::chrono::milliseconds timeout);

  private:
    class Io;
    std::unique_ptr<Io> io_;
};

} // namespace evod::core
