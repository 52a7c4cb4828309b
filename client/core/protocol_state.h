// ProtocolState: the client's side of the protocol, as a state machine without sockets, threads and clocks. After each
// call, the owner calls take_output() and performs the actions that the Output lists.
//
// Owner        Connection, which owns the socket and the timer.
// Threads      none of its own. Only one thread at a time may call it.
// Determinism  the output depends only on the calls and their arguments; the caller passes the time.
#pragma once

#include "client/core/subscriptions.h"

#include <deque>
#include <random>
#include <span>

namespace evod::core {

/// Stores the newest events that the program has not taken yet.
class EventQueue {
  public:
    explicit EventQueue(std::size_t kept) : kept_{std::max<std::size_t>(kept, 1)} {}
    /// Appends an event. If more than `kept` are in the queue, drops the oldest.
    void push(evod::v1::Event event);
    /// Removes and returns the oldest event. If events were dropped, first returns an EventsDropped.
    std::optional<evod::v1::Event> pop();
    bool empty() const { return events_.empty() && dropped_count_ == 0; }

  private:
    std::size_t kept_;
    std::deque<evod::v1::Event> events_;
    std::uint64_t dropped_count_ = 0;
};

/// Why a session ended, or why no session could begin.
struct Ending {
    std::string reason;
    bool final = false;                           // another attempt to connect would fail too
    bool late = false;                            // the server is full: the next attempt follows after backoff_max
    bool token_needed = false;                    // the server requires a (different) token
    std::optional<evod::v1::Status> refusal = {}; // nullopt: the session ended for another reason
};

class ProtocolState {
  public:
    struct Output {
        bool connection_wanted = false;       // false: close the TCP connection; true: open one if there is none
        TimePoint wake_at = TimePoint::max(); // call advance() at this time
        std::string bytes;                    // send them to the server
        std::vector<Outcome> outcomes;        // call their handlers, in this order
        std::vector<evod::v1::Event> events;  // received since the last output
        Snapshots snapshots;                  // decoded since the last output
        Answers answers;                      // the server's last answer to each subscription in this session
        ConnectionStatus status;
    };

    /// client_key  random hexadecimal digits, which identify this client in the server's reply cache.
    /// jitter      seed of the random part of the waits between attempts to connect.
    ProtocolState(Options options, std::string client_key, std::uint32_t jitter, TimePoint now);

    // ---- the TCP connection
    void opened(TimePoint now);
    void received(std::span<const std::byte> bytes, TimePoint now);
    /// Call when the TCP connection was lost or could not be opened. `ending` applies if the server has not announced
    /// its shutdown.
    void lost(Ending ending, TimePoint now);
    /// Ends attempts to connect and requests whose time limit has passed. Begins the next attempt to connect when it is
    /// due.
    void advance(TimePoint now);
    Output take_output();

    // ---- the program
    void request(evod::v1::Request request, Handler handler, std::chrono::milliseconds timeout, TimePoint now);
    /// The program may call only add(), set_view() and remove() of the subscriptions.
    Subscriptions& subscriptions() { return subscriptions_; }
    /// Finishes all requests with the error Closed. The connection cannot be used again.
    void close();

  private:
    /// State that each attempt to connect resets.
    struct SessionState {
        bool opened = false;
        bool going_away = false; // the server has announced its shutdown
        codec::FrameReader reader{codec::client_limits};
    };
    bool connection_wanted() const { return status_.state == State::Connecting || status_.state == State::Connected; }
    void begin_session(TimePoint now);
    void end_session(Ending ending, TimePoint now);
    void take_frame(const codec::Frame& frame, TimePoint now);
    void take_first_message(const evod::v1::ServerMessage& message, TimePoint now);
    void take_message(evod::v1::ServerMessage message, TimePoint now);
    /// The time at which requests fail because there has been no session for too long.
    TimePoint give_up_at() const;

    const Options options_;
    std::string token_; // of Options, or of the server's answer to a join
    ConnectionStatus status_;
    SessionState session_;
    Output output_;
    RequestQueue requests_;
    Subscriptions subscriptions_{requests_};
    std::optional<TimePoint> lost_since_; // when the last session ended; nullopt: there is one, or there was none yet
    TimePoint deadline_; // of the connection or the Welcome; after a loss: the time of the next attempt to connect
    std::chrono::milliseconds backoff_;
    std::minstd_rand jitter_;
};

} // namespace evod::core
