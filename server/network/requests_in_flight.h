// Requests in flight: the unanswered requests of a session, their memory, and the requests that wait
// until a query of the session is answered.
//
// The simulation thread processes at most one query per session at a time, so that all sessions get an equal share of
// its time. Meanwhile all further requests of the session are held back to keep their order.
//
// Owner        the session, on the network thread.
// Full         above requests_in_flight_max, admit() returns false. Held-back requests are admitted requests, too.
#pragma once

#include "evod/v1/session.pb.h"
#include "server/network/send_memory.h"

#include <cstddef>
#include <deque>
#include <optional>

namespace evod::network {

class RequestsInFlight {
  public:
    explicit RequestsInFlight(SendMemory& memory) : expected_bytes_{memory}, held_back_bytes_{memory} {}

    /// Counts one more unanswered request. Returns false if there are already too many; the caller must then refuse the
    /// request with Session::send_unasked().
    bool admit();
    /// The writer has taken the answers to so many requests.
    void count_answered(std::size_t count) { unanswered_ -= count; }
    std::size_t unanswered() const { return unanswered_; }

    /// Reserves memory of requests under way and of answers in preparation. A negative number releases it.
    void expect(std::ptrdiff_t bytes);

    /// To be called when the simulation is to carry out a command, and when its answer exists.
    ///
    /// bytes  memory of the command
    void begin_command(std::size_t bytes);
    void end_command(std::size_t bytes);

    bool query_under_way = false;
    std::size_t commands_under_way = 0; // commands whose answer does not exist yet
    void hold_back(v1::Request request);
    /// Removes and returns the oldest request that was held back; nullopt if there is none.
    std::optional<v1::Request> take_held_back();

    std::size_t held_bytes() const { return expected_bytes_.bytes() + held_back_bytes_.bytes(); }
    /// Drops the requests that are held back, and reserves no more memory. Called when the session has ended.
    void close();

  private:
    std::size_t unanswered_ = 0;
    struct HeldBack {
        v1::Request request;
        std::size_t bytes;
    };
    std::deque<HeldBack> held_back_; // at most requests_in_flight_max entries
    SendMemory::Reservation expected_bytes_, held_back_bytes_;
    bool closed_ = false;
};

} // namespace evod::network
