// RequestQueue: stores each request of a client from the program's call until its outcome is known.
//
// Idempotent: each request carries an increasing number and the key of the client. A request that is unanswered when
// the session ends is sent again in the next session with the same number, so the server executes it only once.
//
// Threads      none of its own.
// Determinism  reads no clock; the caller passes the time.
// Bounded      at most as many requests as the server's limit allows are sent and unanswered; the others wait here.
#pragma once

#include "client/core/client_types.h"

#include <map>
#include <set>
#include <vector>

namespace evod::core {

using Clock = std::chrono::steady_clock;
using TimePoint = Clock::time_point;

/// A finished request. The owner of the queue calls handler(result).
struct Outcome {
    Handler handler;
    Result<evod::v1::Response> result;
};

/// A request without a reply. When the session ends, requests of the program remain and are sent again in the next
/// session. A request for a subscription remains if it was not sent. All others finish, because they have no meaning
/// outside their session.
struct Pending {
    Handler handler = {};                                // set for requests of the program
    std::optional<SubscriptionHandle> subscription = {}; // set for requests for a subscription
    bool first = false;                                  // it is sent before all waiting requests without `first`
    std::chrono::milliseconds timeout{};                 // for the error message
    TimePoint deadline = TimePoint::max();
    std::string frame = {}; // set by the queue
};

class RequestQueue {
  public:
    explicit RequestQueue(std::string client_key) : client_key_{std::move(client_key)} {}

    void set_limits(const evod::v1::Limits& limits) { limits_ = limits; }
    /// Numbers a request and appends it. If the request cannot be sent, its outcome is an error.
    void add(evod::v1::Request request, Pending pending);
    /// Returns whether a request for this subscription is unanswered.
    bool has_request_for(SubscriptionHandle subscription) const;
    /// Finishes the request that this response answers. If that request asked for a subscription, returns the handle of
    /// the subscription. Ignores responses to unknown requests and to requests that were not sent in this session.
    std::optional<SubscriptionHandle> answer(const evod::v1::Response& response);
    /// Finishes all requests whose deadline has passed. Appends `why` to each error.
    void expire(TimePoint now, const std::string& why);
    /// Finishes the requests that will not be sent again. If no session follows (`another` is false), finishes all
    /// requests.
    void end_session(const Error& error, bool another);

    /// Returns the frames to send now, in order: as many as the server's limit on unanswered requests allows.
    std::string take_frames();
    std::vector<Outcome> take_outcomes() { return std::exchange(outcomes_, {}); }
    TimePoint next_deadline() const;

  private:
    using Entries = std::map<std::uint64_t, Pending>; // by request_id
    Entries::iterator finish(Entries::iterator entry, Result<evod::v1::Response> result);

    std::string client_key_;
    evod::v1::Limits limits_;
    std::optional<Error> ended_; // why no request can be sent any more
    std::uint64_t last_id_ = 0;
    Entries pending_;
    // The ids of the requests that were sent in this session and have no reply. After a timeout, a request counts
    // towards the server's limit until its late reply arrives.
    std::set<std::uint64_t> in_flight_;
    std::vector<Outcome> outcomes_;
};

} // namespace evod::core
