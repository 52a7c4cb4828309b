// Session: one TCP connection. Reads requests and writes answers, events and snapshots.
//
// Owner        the server's table of sessions; its two coroutines keep it alive until the connection has ended.
// Threads      the network thread.
// Full         backpressure per kind. Requests: reading pauses above requests_per_s_max. Responses: the session closes
//              when more than queued_response_bytes_max are unread. Events: dropped, counted and reported with
//              EventsDropped. Snapshots: of each subscription and island only the newest waits, until earlier ones are
//              acknowledged and the bandwidth allows it. A client that receives nothing for a while is closed.
#pragma once

#include "evod/v1/session.pb.h"
#include "proto/codec/framing.h"
#include "server/access/gate.h"
#include "server/base/result.h"
#include "server/metrics/traffic.h"
#include "server/network/limits.h"
#include "server/network/messages.h"
#include "server/network/send_memory.h"
#include "server/network/token_bucket.h"
#include "server/network/transport.h"
#include "server/runtime/clock.h"
#include "server/streaming/snapshot_queue.h"

#include <boost/asio/steady_timer.hpp>

#include <array>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace evod::network {

class Session;
using SessionPtr = std::shared_ptr<Session>;

/// What a session needs from the rest of the server.
struct SessionHost {
    LimitCounters& limit_counters;
    SendMemory& send_memory;
    v1::Limits limits = {};
    std::string instance_id = {}; // 32 hexadecimal digits
    v1::Durability durability = v1::DURABILITY_NONE;
    std::optional<v1::Storage> storage = {}; // the current state of the disk; nullopt: runs are not stored
    asio::ssl::context* tls = nullptr;       // nullptr: without TLS
    metrics::Traffic traffic = {};
    runtime::Clock* clock = nullptr;
    /// The rate limit of log lines about sessions that ended without a Hello.
    struct UngreetedLog {
        std::optional<TokenBucket> lines = {}; // created with the first line
        std::uint64_t left_out = 0;            // lines left out since the last one
    } ungreeted_log = {};
    std::string frame = {}; // working memory to assemble frames of snapshots
    /// Authenticates a client by its token and address.
    std::function<base::Result<access::Visitor>(const std::string& token, const std::string& address)> admit = {};
    std::function<void(Session&, v1::Request)> handle = {};
    std::function<void(Session&)> ended = {}; // called once
};

struct EventSubscription {
    std::optional<std::string> world; // nullopt: all
};

class Session : public std::enable_shared_from_this<Session>, private streaming::SnapshotSender {
  public:
    Session(tcp::socket socket, SessionHost& host, std::uint64_t number);

    /// Starts reading and writing. refusal: send only this as a Goodbye.
    void start(const std::optional<base::Refusal>& refusal = {});

    std::uint64_t number() const { return number_; }
    bool greeted() const { return greeted_; }
    /// User, client name and address: "anna: evoview 127.0.0.1:51234".
    std::string by() const;
    /// The limits of this session's role.
    v1::Limits limits() const;
    const access::Visitor& visitor() const { return visitor_; }
    /// The key of limits per address: the IPv4 address or the IPv6 /64.
    const std::string& neighbourhood() const { return neighbourhood_; }

    /// Counts one more unanswered request. false: too many; refuse it with send_unasked().
    bool admit_request();
    /// Adds to the memory reserved for answers in preparation; negative when an answer is ready.
    void expect(std::ptrdiff_t bytes);
    /// Sends the answer to an admitted request.
    void answer(SharedBytes frame);
    /// Likewise; logs a refusal.
    void answer(v1::Response response);
    /// Sends a response to a message that was not admitted.
    void send_unasked(const v1::Response& response);
    void event(const SharedBytes& frame);
    void count_dropped_events(std::uint64_t count);
    /// Sends a Goodbye with the refusal and ends the session.
    void fail(const base::Refusal& refusal);
    /// Reads no more requests, writes what waits, then closes.
    void finish();
    /// Closes at once.
    void close();

    /// Closes the session if its client has received nothing for stalled_timeout. Call it periodically.
    ///
    /// watched  how long the server could observe the client since the last call.
    void check_progress(runtime::Clock::duration watched);
    /// Bytes that closing the session would release.
    std::size_t held_bytes() const;
    /// Closes the session because the memory of all sessions is exhausted.
    void evict();

    std::uint32_t next_subscription_id() { return ++subscription_id_; }
    streaming::SnapshotQueue snapshots; // its subscriptions to snapshots, and what waits of them
    std::map<std::uint32_t, EventSubscription> events;
    std::set<std::string> replays; // names of the replays that the session has opened

    // The simulation has at most one query per session, so that sessions share its time evenly. Further requests are held
    // back, so that they keep their order.
    bool query_under_way = false;
    void hold_back(v1::Request request);
    /// The oldest request held back; nullopt: none.
    std::optional<v1::Request> take_held_back();

  private:
    enum class Kind { Answer, Unasked, Event, Snapshot };
    struct Queued {
        SendMemory::Counted bytes; // a frame, or a part of a snapshot
        Kind kind;
    };

    asio::awaitable<void> read();
    /// Bounds the time for a started frame to arrive. one_came: a frame was completed since the last call.
    void update_frame_timer(bool one_came);
    asio::awaitable<void> write();
    /// Waits until the rate limit allows `cost`.
    asio::awaitable<void> wait_for_turn(double cost);
    /// Reads no more, and calls fail() once all requests are answered.
    asio::awaitable<void> fail_when_answered(base::Refusal refused);
    asio::awaitable<void> discard_input();
    asio::awaitable<void> wait_for_work(runtime::Clock::time_point until = runtime::Clock::time_point::max());
    void on_frame(const codec::Frame& frame);
    /// The bound of the client's frames after the Hello.
    std::uint32_t control_frame_bytes_max() const;
    void on_hello(const v1::Hello& hello);
    void send_snapshots() override;
    void send_snapshots_later() override { wake_writer(); }
    /// Writes a frame as far as the connection accepts it at once. The rest goes into sending_ and rest_ for the writer.
    void send_frame(const streaming::OutgoingFrame& frame);
    bool may_send_snapshots() const;
    void enqueue(SharedBytes frame, Kind kind);
    /// Whether the client accepts a frame of that size, header included.
    bool takes(std::size_t frame_bytes) const { return frame_bytes - codec::header_bytes <= frame_bytes_max_; }
    void written(const Queued& queued);
    void wake_writer();
    void log_connection(const std::string& what) const;
    /// code: may be empty.
    void log_closed(std::string_view code, const std::string& why);
    void end();

    Transport transport_;
    SessionHost& host_;
    const std::uint64_t number_;
    const tcp::endpoint peer_;
    const std::string neighbourhood_;
    std::string client_;
    access::Visitor visitor_;
    std::size_t frame_bytes_max_ = std::numeric_limits<std::size_t>::max(); // the largest body that the client accepts
    codec::FrameReader reader_{codec::hello_limits};
    SendMemory::Reservation reader_bytes_, expected_bytes_, held_back_bytes_;
    struct HeldBack {
        v1::Request request;
        std::size_t bytes;
    };
    std::deque<HeldBack> held_back_; // at most requests_in_flight_max
    TokenBucket turns_to_send_;
    asio::steady_timer hello_timer_, frame_timer_, turn_timer_, farewell_timer_, writer_signal_;
    bool within_frame_ = false; // a frame has begun to arrive
    bool begun_ = false;        // the transport can be written to
    bool idle_ = false;         // the writer waits for work
    bool greeted_ = false, finishing_ = false, ended_ = false;
    bool input_over_ = false; // the client sends nothing more
    int coroutines_ = 0;      // still running

    std::deque<Queued> queue_;
    std::vector<Queued> sending_; // not empty: a write is in progress or due
    struct Rest {
        std::array<std::byte, codec::header_bytes> header;
        std::string tail;
        std::vector<asio::const_buffer> buffers;       // of these, and of what is in sending_
    } rest_;                                           // of a snapshot that the connection did not accept at once
    std::size_t response_bytes_ = 0, event_bytes_ = 0; // in queue_ and sending_
    Transport::Progress progress_;
    runtime::Clock::duration stalled_{}; // observed time without progress
    std::size_t in_flight_ = 0;          // requests whose answer is not being written yet
    std::uint64_t dropped_events_ = 0;   // not reported yet
    std::uint32_t subscription_id_ = 0;
};

} // namespace evod::network
