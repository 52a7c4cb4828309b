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
#include "server/access/gate.h"
#include "server/base/result.h"
#include "server/metrics/traffic.h"
#include "server/network/limits.h"
#include "server/network/messages.h"
#include "server/network/page_address.h"
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
/// The key is the number of the session.
using Sessions = std::map<std::uint64_t, SessionPtr>;
/// Returns the session with this number; nullptr if it has ended.
SessionPtr find_session(const Sessions& sessions, std::uint64_t number);

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
    /// Limits the rate of log lines about sessions that ended without a Hello.
    struct UngreetedLog {
        std::optional<TokenBucket> lines = {}; // created when the first line is logged
        std::uint64_t left_out = 0;            // number of lines omitted since the last logged line
    } ungreeted_log = {};
    std::string frame = {}; // reused buffer in which frames of snapshots are assembled
    /// Authenticates a client by its token and address.
    std::function<base::Result<access::Visitor>(const std::string& token, const std::string& address)> admit = {};
    std::function<void(Session&, v1::Request)> handle = {};
    std::function<void(Session&)> ended = {}; // called once, when the session has ended
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
    bool greeted() const { return greeted_; }
    /// User, client name and address: "anna: evoview 127.0.0.1:51234".
    std::string by() const;
    /// The limits that apply to the role of this session.
    v1::Limits limits() const;
    const access::Visitor& visitor() const { return visitor_; }
    /// The IPv4 address, or the /64 prefix of the IPv6 address. The limits per address count the sessions with an equal
    /// prefix.
    const std::string& address_prefix() const { return address_prefix_; }

    /// Counts one more unanswered request. Returns false if there are already too many; the caller must then refuse the
    /// request with send_unasked().
    bool admit_request();
    /// Reserves memory for answers in preparation. A negative number releases it when the answer is ready.
    void expect(std::ptrdiff_t bytes);
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
    /// Number of bytes that would be released if this session were closed.
    std::size_t held_bytes() const;
    /// Closes the session because all sessions together use too much memory.
    void evict();

    std::uint32_t next_subscription_id() { return ++subscription_id_; }
    streaming::SnapshotQueue snapshots; // the subscriptions to snapshots, and the snapshots that wait to be sent
    std::map<std::uint32_t, EventSubscription> events;
    std::set<std::string> replays; // names of the replays that the session has opened

    // The simulation thread processes at most one query per session at a time, so that all sessions get an equal share
    // of its time. Meanwhile all further requests of the session are held back to keep their order.
    bool query_under_way = false;
    void hold_back(v1::Request request);
    /// Removes and returns the oldest request that was held back; nullopt if there is none.
    std::optional<v1::Request> take_held_back();

  private:
    enum class Kind { Answer, Unasked, Event, Snapshot };
    struct Queued {
        SendMemory::Counted bytes; // a frame or a part of a snapshot
        Kind kind;
    };

    asio::awaitable<void> read();
    /// Limits the rate of frames of the WebSocket that have no content.
    void count_empty_frames();
    /// Sends a ping to a silent client of a WebSocket, and closes the session if there is no answer.
    void check_silence(runtime::Clock::duration watched);
    /// Limits the time from the first to the last byte of a frame.
    void update_frame_timer();
    asio::awaitable<void> write();
    /// Waits until the rate limit allows a frame of this cost.
    asio::awaitable<void> wait_for_turn(double cost);
    /// Stops reading, and calls fail() once all requests are answered.
    asio::awaitable<void> fail_when_answered(base::Refusal refused);
    asio::awaitable<void> discard_input();
    asio::awaitable<void> wait_for_work(runtime::Clock::time_point until = runtime::Clock::time_point::max());
    void on_frame(const codec::Frame& frame);
    /// The largest frame body that this client may send after its Hello.
    std::uint32_t control_frame_bytes_max() const;
    void on_hello(const v1::Hello& hello);
    void send_snapshots() override;
    void send_snapshots_later() override { wake_writer(); }
    /// Writes as much of a frame as the connection accepts at once. The writer sends the rest from sending_ and rest_.
    void send_frame(const streaming::OutgoingFrame& frame);
    bool may_send_snapshots() const;
    void enqueue(SharedBytes frame, Kind kind);
    /// Whether the client accepts a frame of this size. The size includes the header.
    bool takes(std::size_t frame_bytes) const { return frame_bytes - codec::header_bytes <= frame_bytes_max_; }
    void written(const Queued& queued);
    void wake_writer();
    void log_connection(const std::string& what) const;
    /// code  name of the refusal's code; empty: the session was not refused.
    void log_closed(std::string_view code, const std::string& why);
    void end();

    std::unique_ptr<Transport> transport_; // never nullptr
    SessionHost& host_;
    const std::uint64_t number_;
    const tcp::endpoint peer_;
    const std::string address_prefix_;
    std::string client_;
    access::Visitor visitor_;
    std::size_t frame_bytes_max_ = std::numeric_limits<std::size_t>::max(); // the largest body that the client accepts
    codec::FrameReader reader_{codec::hello_limits};
    SendMemory::Reservation reader_bytes_, expected_bytes_, held_back_bytes_;
    struct HeldBack {
        v1::Request request;
        std::size_t bytes;
    };
    std::deque<HeldBack> held_back_; // at most requests_in_flight_max entries
    TokenBucket turns_to_send_, empty_frames_;
    asio::steady_timer hello_timer_, frame_timer_, turn_timer_, farewell_timer_, writer_signal_;
    bool within_frame_ = false; // a part of a frame has arrived
    bool begun_ = false;        // the transport is ready for writing
    bool idle_ = false;         // the writer waits for data to send
    bool greeted_ = false, finishing_ = false, ended_ = false;
    bool reading_ = false;                     // a read is in progress
    std::optional<WebSocketClose> close_code_; // why the session ends; nullopt: for no particular reason
    bool input_over_ = false;                  // nothing more is read, but pending answers are still sent
    int coroutines_ = 0;                       // number of running coroutines

    std::deque<Queued> queue_;
    std::vector<Queued> sending_; // not empty: a write is in progress or about to start
    struct UnsentPart {
        std::array<std::byte, codec::header_bytes> header;
        std::string tail;
        std::vector<asio::const_buffer> buffers; // point to `header`, `tail` and the bytes in sending_
    } rest_;                                     // the rest of a snapshot that the connection did not accept at once
    std::size_t response_bytes_ = 0, event_bytes_ = 0; // bytes in queue_ and sending_
    Transport::Progress progress_;
    runtime::Clock::duration stalled_{}; // time in which the client was observed and received nothing
    runtime::Clock::duration silent_{};  // time in which the client of a WebSocket could send and sent nothing
    std::size_t in_flight_ = 0;          // number of requests whose answers the writer has not taken yet
    std::uint64_t dropped_events_ = 0;   // number of dropped events that were not reported yet
    std::uint32_t subscription_id_ = 0;
};

} // namespace evod::network
