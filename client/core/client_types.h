// Client types: the address, options, status and errors that a program and its Connection exchange.
#pragma once

#include "evod/v1/session.pb.h"
#include "proto/codec/framing.h"

#include <boost/system/result.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

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

/// A function that receives the reply to a request, or the reason why no reply arrived.
using Handler = std::function<void(Result<evod::v1::Response>)>;

inline bool accepted(const evod::v1::Response& response) {
    return response.status().code() == evod::v1::CODE_UNSPECIFIED;
}

/// Returns whether the worlds are waiting for the server's disk.
inline bool worlds_wait(const evod::v1::Storage& storage) {
    return storage.state() == evod::v1::STORAGE_STATE_STALLED || storage.state() == evod::v1::STORAGE_STATE_BEHIND;
}

/// Returns how many islands of a world that waits for fitness have been rated: "0 of 2 islands rated".
std::string to_text(const evod::v1::AwaitedFitness& awaited, std::uint32_t island_count);

/// Returns the message for people: a sentence, then lines about fields. Programs read the code, the reason and the
/// fields.
///
/// name_of  the client's own name for the path of a field, such as "set_parameters.mutation_chance"; empty: the path.
std::string to_text(const evod::v1::Status& status,
                    const std::function<std::string(std::string_view path)>& name_of = {});

/// Returns the sentence about an event. For an event of a server that sends none, or of this client itself, returns the
/// fields.
std::string to_text(const evod::v1::Event& event);

/// Returns the problem with the server's run files in one sentence; empty if there is none.
inline const std::string& to_text(const evod::v1::Storage& storage) {
    return storage.text().empty() ? storage.reason() : storage.text();
}

// ---- the connection --------------------------------------------------------------------------------------------

struct Options {
    Endpoint server{};
    std::string token = ""; // empty: none
    // Connects as a member of a class, instead of with a token; later sessions use the token that the server has sent.
    struct Join {
        std::string code;      // of the class, or a personal code
        std::string name = ""; // of a new member; empty: the server makes one up
    };
    std::optional<Join> join = {};
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
    // Requests fail if there has been no session for this long; nullopt: they wait until their own timeout.
    std::optional<std::chrono::milliseconds> unreachable_max = {};
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

} // namespace evod::core
