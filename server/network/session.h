// Session: one TCP connection. Reads requests, and writes answers, events and pictures, whichever its client takes.
//
// Owner        the server's table of sessions, until the connection ends; its two coroutines keep it alive meanwhile.
// Threads      the network thread.
// Full         requests: more than requests_per_s_max are not read before it is time. Responses: a client that leaves
//              more than queued_response_bytes_max unread is closed. Events: dropped and counted, then told with
//              EventsDropped. Pictures: one of each subscription and island waits, the newest, until the client has
//              acknowledged enough of those before it, and its budget allows it. Whoever takes nothing at all for a
//              while is closed.
#pragma once

#include "evod/v1/session.pb.h"
#include "proto/codec/framing.h"
#include "server/access/gate.h"
#include "server/base/result.h"
#include "server/metrics/traffic.h"
#include "server/network/buffers.h"
#include "server/network/limits.h"
#include "server/network/line.h"
#include "server/network/token_bucket.h"
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

/// What a session needs of the rest of the server.
struct SessionHost {
    LimitCounters& limit_counters;
    Buffers& buffers;
    v1::Limits limits = {};
    std::string instance_id = {}; // 32 hexadecimal digits
    v1::Durability durability = v1::DURABILITY_NONE;
    std::optional<v1::Storage> storage = {}; // as it stands now; nothing: runs are not kept
    asio::ssl::context* tls = nullptr;       // nullptr: in the clear
    metrics::Traffic traffic = {};
    runtime::Clock* clock = nullptr;
    /// Lines about sessions that were closed without a hello.
    struct StrangersLog {
        std::optional<TokenBucket> lines = {}; // from the first on
        std::uint64_t left_out = 0;            // since the last that was logged
    } strangers_log = {};
    std::string frame = {}; // working memory: where frames of pictures are put together
    /// Who comes with a token, from an address.
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

    /// Begins to read and write. refusal: instead of a hello's welcome, and the end.
    void start(const std::optional<base::Refusal>& refusal = {});

    std::uint64_t number() const { return number_; }
    bool greeted() const { return greeted_; }
    /// Client name and address, and whose token it has: "anna: evoview 127.0.0.1:51234".
    std::string by() const;
    /// As they are for this session.
    v1::Limits limits() const;
    const access::Visitor& visitor() const { return visitor_; }
    /// Where it comes from, as far as an address tells people apart: of IPv6, its /64.
    const std::string& neighbourhood() const { return neighbourhood_; }

    /// One more request to be answered; false: too many are, and it must be refused with send_unasked().
    bool admit_request();
    /// An answer to it may become so long; a difference, below 0 when it is there.
    void expect(std::ptrdiff_t bytes);
    /// The answer to an admitted request.
    void answer(SharedBytes frame);
    /// The same; a refusal is logged.
    void answer(v1::Response response);
    /// A response to something that was not admitted.
    void send_unasked(const v1::Response& response);
    void event(const SharedBytes& frame);
    void count_dropped_events(std::uint64_t count);
    /// Says what was wrong, and ends the session.
    void fail(const base::Refusal& refusal);
    /// Writes what is waiting, then closes; no more requests are read.
    void finish();
    /// Closes now.
    void close();

    /// Whether its client takes what is sent; one that does not is closed. To be called now and then.
    /// watched  how long the server has been able to see that, since the last call.
    void mind_progress(runtime::Clock::duration watched);
    /// Memory that closing it would free.
    std::size_t held_bytes() const;
    /// Closes it, for there is no room for what waits for all.
    void make_room();

    std::uint32_t next_subscription_id() { return ++subscription_id_; }
    streaming::SnapshotQueue snapshots; // its subscriptions to snapshots, and what waits of them
    std::map<std::uint32_t, EventSubscription> events;
    std::set<std::string> pasts; // worlds that it has opened to look at the past

    // One query of a session at a time is with the simulation, so that sessions share its time evenly. Requests that
    // come meanwhile are held back, so that all are carried out in their order.
    bool query_under_way = false;
    void hold_back(v1::Request request);
    /// The next of those; nullopt: there is none.
    std::optional<v1::Request> take_held_back();

  private:
    enum class Kind { Answer, Unasked, Event, Snapshot };
    struct Queued {
        Buffers::Held bytes; // a frame, or a part of a snapshot
        Kind kind;
    };

    asio::awaitable<void> read();
    /// A frame that has begun has to come whole in time. one_came: since the last call.
    void mind_frame(bool one_came);
    asio::awaitable<void> write();
    /// Until the client may go on, if it has sent too much for now.
    asio::awaitable<void> wait_for_turn(double cost);
    /// Reads no more, and fails once all that was asked is answered.
    asio::awaitable<void> fail_when_answered(base::Refusal refused);
    asio::awaitable<void> discard_input();
    asio::awaitable<void> wait_for_work(runtime::Clock::time_point until = runtime::Clock::time_point::max());
    void on_frame(const codec::Frame& frame);
    /// Of a frame from the client, after its hello.
    std::uint32_t control_frame_bytes_max() const;
    void on_hello(const v1::Hello& hello);
    void send_snapshots() override;
    void send_snapshots_later() override { wake_writer(); }
    /// Writes a frame as far as the connection accepts it at once. The rest goes into sending_ and rest_ for the writer.
    void send_frame(const streaming::OutgoingFrame& frame);
    bool may_send_snapshots() const;
    void enqueue(SharedBytes frame, Kind kind);
    /// Whether the client takes a frame of that size, header included.
    bool takes(std::size_t frame_bytes) const { return frame_bytes - codec::header_bytes <= frame_bytes_max_; }
    void written(const Queued& queued);
    void wake_writer();
    void log_coming_or_going(const std::string& what) const;
    /// code: empty: none.
    void log_closed(std::string_view code, const std::string& why);
    void end();

    Line line_;
    SessionHost& host_;
    const std::uint64_t number_;
    const tcp::endpoint peer_;
    const std::string neighbourhood_;
    std::string client_;
    access::Visitor visitor_;
    std::size_t frame_bytes_max_ = std::numeric_limits<std::size_t>::max(); // of a body that the client takes
    codec::FrameReader reader_{codec::hello_limits};
    Buffers::Own reader_bytes_, expected_bytes_, held_back_bytes_;
    struct HeldBack {
        v1::Request request;
        std::size_t bytes;
    };
    std::deque<HeldBack> held_back_; // requests_in_flight_max at most
    TokenBucket turns_to_send_;
    asio::steady_timer hello_timer_, frame_timer_, turn_timer_, farewell_timer_, writer_signal_;
    bool within_frame_ = false; // a frame has begun to come
    bool begun_ = false;        // the line can be written to
    bool idle_ = false;         // the writer waits for work, and has not been woken
    bool greeted_ = false, finishing_ = false, ended_ = false;
    bool input_over_ = false; // the client will send nothing more
    int coroutines_ = 0;      // that still run

    std::deque<Queued> queue_;
    std::vector<Queued> sending_; // not empty: the line is being written to, or is to be
    struct Rest {
        std::array<std::byte, codec::header_bytes> header;
        std::string tail;
        std::vector<asio::const_buffer> buffers;       // of these, and of what is in sending_
    } rest_;                                           // of a snapshot that the connection did not accept at once
    std::size_t response_bytes_ = 0, event_bytes_ = 0; // in both
    Line::Progress progress_;
    runtime::Clock::duration stalled_{}; // seen to take nothing, though something waited
    std::size_t in_flight_ = 0;          // requests whose answer is not yet being written
    std::uint64_t dropped_events_ = 0;   // not yet told
    std::uint32_t subscription_id_ = 0;
};

/// At Level::Debug, if it says no. by: whom.
void log_refusal(std::uint64_t session, const std::string& by, const v1::Response& response);

SharedBytes encode_control(const v1::ServerMessage& message);
SharedBytes encode_response(v1::Response response);
SharedBytes encode_event(v1::Event event);
SharedBytes encode_goodbye(const base::Refusal& why);

} // namespace evod::network
