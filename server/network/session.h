// Session: one connection, over TCP or in a WebSocket. It reads requests and writes answers, events and snapshots.
//
// Owner        the server's table of sessions. The two coroutines of a session keep it alive until the connection has
//              ended.
// Threads      the network thread.
// Full         backpressure differs by kind of message.
//              Requests: above requests_per_s_max the session pauses reading.
//              Responses: if more than queued_response_bytes_max are unread, the session is closed.
//              Events: if more than queued_event_bytes_max are unread, further events are dropped, and EventsDropped
//              reports their number.
//              Snapshots: for each subscription and island, only the newest snapshot waits to be sent. It waits until
//              earlier ones are acknowledged and the bandwidth limit allows it.
//              A session whose client receives nothing for stalled_timeout is closed.
#pragma once

#include "evod/v1/session.pb.h"
#include "proto/codec/framing.h"
#include "server/access/authentication.h"
#include "server/base/result.h"
#include "server/metrics/traffic.h"
#include "server/network/client_watch.h"
#include "server/network/large_frames.h"
#include "server/network/limits.h"
#include "server/network/log_limit.h"
#include "server/network/messages.h"
#include "server/network/page_address.h"
#include "server/network/rate_limit.h"
#include "server/network/requests_in_flight.h"
#include "server/network/send_memory.h"
#include "server/network/send_queue.h"
#include "server/network/signal.h"
#include "server/network/transport.h"
#include "server/runtime/clock.h"
#include "server/streaming/snapshot_queue.h"

#include <boost/asio/steady_timer.hpp>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace evod::log {
enum class Level;
}

namespace evod::network {

class Session;
using SessionPtr = std::shared_ptr<Session>;
/// The key is the number of the session.
using Sessions = std::map<std::uint64_t, SessionPtr>;
/// Returns the session with this number; nullptr if it has ended.
SessionPtr find_session(const Sessions& sessions, std::uint64_t number);

/// Whose quota the sessions of a user use or, without a user, those from an address. No user has the name of an
/// address's account.
std::string account_of(const std::string& user, const std::string& address_prefix);

/// A member of a class who may connect.
struct AdmittedMember {
    access::AuthenticatedUser user;
    v1::Membership membership;
};

/// The interface of the server that a session uses.
struct SessionHost {
    LimitCounters& limit_counters;
    SendMemory& send_memory;
    v1::Limits limits = {};
    std::string instance_id = {}; // 32 hexadecimal digits
    PageAddress page = {};
    v1::Durability durability = v1::DURABILITY_NONE;
    std::optional<v1::Storage> storage = {}; // current state of the disk; nullopt: runs are not stored
    asio::ssl::context* tls = nullptr;       // nullptr: no TLS
    metrics::Traffic traffic = {};
    runtime::Clock* clock = nullptr;
    LogLimit log_limit = {};
    LargeFrames large_frames = {};
    std::string frame = {}; // reused buffer in which frames of snapshots are assembled
    /// Authenticates a client by its token and address.
    std::function<base::Result<access::AuthenticatedUser>(const std::string& token, const std::string& address)> admit =
        {};
    /// Authenticates a member of a class. nullopt: the Hello is not that of a member.
    std::function<std::optional<base::Result<AdmittedMember>>(const v1::Hello& hello)> admit_member =
        [](const v1::Hello&) { return std::nullopt; };
    /// Makes room for one more session of this account. Returns nullopt, or why there is none.
    std::function<std::optional<base::Refusal>(const std::string& account)> make_room = [](const std::string&) {
        return std::nullopt;
    };
    std::function<void(Session&, v1::Request)> handle = {};
    std::function<void(Session&)> ended = {}; // called once, when the session has ended
    /// Returns, by session, its part of the memory of the snapshots that sessions share.
    std::function<std::map<std::uint64_t, std::size_t>()> shared_snapshot_bytes = {};
};

struct EventSubscription {
    std::optional<std::string> world; // nullopt: all worlds
};

class Session : public std::enable_shared_from_this<Session>, private streaming::SnapshotSender {
  public:
    Session(tcp::socket socket, SessionHost& host, std::uint64_t number);
    Session(std::unique_ptr<Transport> transport, SessionHost& host, std::uint64_t number);

    /// Starts reading and writing.
    ///
    /// refusal  if set, the session only sends a Goodbye with this refusal.
    void start(const std::optional<base::Refusal>& refusal = {});

    std::uint64_t number() const { return number_; }
    bool greeted() const { return user_.has_value(); }
    /// The client of this session.
    base::Actor actor() const;
    /// The client of this session for log lines: "anna: evoview 127.0.0.1:51234".
    std::string by() const { return to_text(actor()); }
    /// The limits that apply to the role of this session.
    v1::Limits limits() const;
    /// The user of the session, which must have received its Hello.
    const access::AuthenticatedUser& user() const { return *user_; }
    /// The IPv4 address, or the prefix of the IPv6 address that identifies one site.
    const std::string& address_prefix() const { return address_prefix_; }
    /// Whose quota the session uses: the name of its token or, without a token, its address prefix.
    const std::string& account() const { return account_; }
    /// Whether the session is closed, or will be once its queued data is sent.
    bool is_over() const { return phase_ >= Phase::Finishing; }

    /// Sends the answer to an admitted request.
    void answer(SharedBytes frame);
    /// Sends the answer to an admitted request, and logs it if it is a refusal.
    void answer(v1::Response response);
    /// Sends a response to a message that was not admitted as a request.
    void send_unasked(const v1::Response& response);
    void event(const SharedBytes& frame);
    void count_dropped_events(std::uint64_t count);
    /// Sends a Goodbye with the refusal and ends the session.
    void fail(const base::Refusal& refusal);
    /// Stops reading, writes the queued data, then closes the connection.
    void finish();
    /// Closes the connection at once.
    void close();

    /// Closes the session if its client has received nothing for stalled_timeout, or has not answered a ping of the
    /// WebSocket. Must be called periodically.
    ///
    /// watched  the part of the time since the last call in which the server was able to observe the client.
    void check_progress(runtime::Clock::duration watched);
    /// Number of bytes that would be released if this session were closed, without the snapshots that it shares.
    std::size_t held_bytes() const;
    /// Closes the session because its user's sessions, or all sessions together, use too much memory.
    ///
    /// why    what exceeds its limit: "all sessions use more than 256 MiB"
    /// bytes  its part of this memory
    void evict(std::string_view why, std::size_t bytes);
    /// Makes the rate limit count so many frames more, because a request causes as much work.
    void charge(std::size_t frames) { rate_limit_.charge(static_cast<double>(frames)); }
    /// Sets the memory of the session's replays and seeks.
    void hold_replays(std::size_t bytes) { replay_bytes_.set(phase_ == Phase::Ended ? 0 : bytes); }
    /// Must be called after the subscriptions to snapshots have changed.
    void count_subscriptions() { subscription_bytes_.set(snapshots.held_bytes()); }

    std::uint32_t next_subscription_id() { return ++subscription_id_; }
    streaming::SnapshotQueue snapshots; // the subscriptions to snapshots, and the snapshots that wait to be sent
    std::map<std::uint32_t, EventSubscription> events;
    std::set<std::string> replays; // names of the replays that the session has opened
    RequestsInFlight requests;

  private:
    /// The phases of a session, in their order. A session may leave some out.
    enum class Phase {
        Connecting, // the transport is not ready for writing
        Open,
        InputOver, // nothing more is read, but pending answers are still sent until answers_timeout
        Finishing, // only the queued data is still sent
        Ended,     // the connection is closed
    };
    /// What the client must do in time. The waits exclude each other: hello_timeout is shorter than frame_timeout.
    enum class Deadline { None, Hello, Frame, Answers, Farewell };
    using Kind = SendQueue::Kind;

    asio::awaitable<void> read();
    /// Limits the rate of frames of the WebSocket that have no content.
    void count_empty_frames();
    /// Sends a ping to a silent client of a WebSocket, and closes the session if there is no answer.
    void check_silence(runtime::Clock::duration watched);
    /// Limits the time from the first to the last byte of a frame.
    void update_frame_deadline();
    /// Replaces the present deadline.
    void begin(Deadline deadline, std::chrono::seconds time);
    /// Ends this deadline, if the session waits for it.
    void end(Deadline deadline);
    void on_missed(Deadline deadline);
    asio::awaitable<void> write();
    /// Waits until the rate limit allows a frame of this cost.
    asio::awaitable<void> wait_for_rate_limit(double cost);
    /// Waits until a large frame of this user may be parsed.
    asio::awaitable<void> wait_for_large_frame();
    /// Stops reading, and calls fail() once all requests are answered.
    asio::awaitable<void> fail_when_answered(base::Refusal refused);
    asio::awaitable<void> discard_input();
    void on_frame(const codec::Frame& frame);
    /// The largest frame body that this client may send after its Hello.
    std::uint32_t control_frame_bytes_max() const;
    void on_hello(const v1::Hello& hello);
    void send_snapshots() override;
    void send_snapshots_later() override { writer_.notify(); }
    /// Writes as much of a frame as the connection accepts at once. The writer sends the rest.
    void send_frame(const streaming::OutgoingFrame& frame);
    bool may_send_snapshots() const;
    void enqueue(SharedBytes frame, Kind kind);
    void log_connection(const std::string& what) const;
    /// code  name of the refusal's code; empty: the session was not refused.
    void log_closed(std::string_view code, const std::string& why);
    /// Logs a line about this session, unless there are too many lines about its user.
    void log_line(log::Level level, std::string_view code, const std::string& what) const;
    void end_coroutine();

    std::unique_ptr<Transport> transport_; // never nullptr
    SessionHost& host_;
    const std::uint64_t number_;
    const tcp::endpoint peer_;
    const std::string address_prefix_;
    std::string account_, client_;
    std::optional<access::AuthenticatedUser> user_; // nullopt: no Hello was received
    Phase phase_ = Phase::Connecting;
    Deadline deadline_ = Deadline::None;
    asio::steady_timer deadline_timer_;
    int coroutines_ = 0;                       // number of running coroutines
    std::optional<WebSocketClose> close_code_; // why the session ends; nullopt: for no particular reason

    codec::FrameReader reader_{codec::hello_limits};
    SendMemory::Reservation reader_bytes_, subscription_bytes_, replay_bytes_;
    RateLimit rate_limit_, empty_frame_limit_;
    Signal turn_; // ends a wait of the coroutine that reads
    ClientWatch watch_;

    SendQueue queue_;
    Signal writer_; // ends a wait of the coroutine that writes
    std::uint32_t subscription_id_ = 0;
};

} // namespace evod::network
