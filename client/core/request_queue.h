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
/// session, unless they end with their session (session_requests.h). A request for a subscription remains if it was not
/// sent. All others finish, because they have no meaning outside their session.
struct Pending {
    Handler handler = {};                                // set for requests of the program
    std::optional<SubscriptionHandle> subscription = {}; // set for requests for a subscription
    bool first = false;                                  // it is sent before all waiting requests without `first`
    std::chrono::milliseconds timeout{};                 // for the error message
    TimePoint deadline = TimePoint::max();
    // The queue sets the following fields.
    std::string frame = {};
    bool ends_with_session = false, opens_replay = false, sets_view = false;
};

/// A request for a subscription that was answered.
struct AnsweredSubscription {
    SubscriptionHandle handle;
    bool sets_view = false; // it was SetView; false: it asked for the subscription
};

class RequestQueue {
  public:
    explicit RequestQueue(std::string client_key) : client_key_{std::move(client_key)} {}

    /// Call it when the server has sent its Welcome.
    void begin_session(const evod::v1::Limits& limits);
    /// Numbers a request and appends it. If the request cannot be sent, its outcome is an error. If it names a replay
    /// that was opened in an earlier session, its outcome is the refusal NOT_FOUND.
    void add(evod::v1::Request request, Pending pending);
    /// Returns whether a name is that of a replay of an earlier session. While there is no session, that holds for
    /// each.
    bool has_ended(const std::string& replay) const {
        return !replay.empty() && (lost_ || ended_replays_.contains(replay));
    }
    /// Returns whether a request for this subscription is unanswered.
    bool has_request_for(SubscriptionHandle subscription) const;
    /// Finishes the request that this response answers. If that request was for a subscription, returns the
    /// subscription. Ignores responses to unknown requests and to requests that were not sent in this session. Closes a
    /// replay whose OpenReplay has timed out.
    std::optional<AnsweredSubscription> answer(const evod::v1::Response& response);
    /// Finishes all requests whose deadline has passed. Appends `why` to each error.
    void expire(TimePoint now, const std::string& why);
    /// Finishes the requests that will not be sent again. If no session follows (`another` is false), finishes all
    /// requests.
    void end_session(const Error& error, bool another);
    /// Finishes the requests of the program, because the server has not been reachable for too long.
    void give_up(const Error& error);

    /// Returns the frames to send now, in order: up to half of the server's limit on unanswered requests.
    std::string take_frames();
    std::vector<Outcome> take_outcomes() { return std::exchange(outcomes_, {}); }
    TimePoint next_deadline() const;
    /// Returns whether a request of the program is unanswered.
    bool has_request_of_program() const;

  private:
    using Entries = std::map<std::uint64_t, Pending>; // by request_id
    Entries::iterator finish(Entries::iterator entry, Result<evod::v1::Response> result);

    std::string client_key_;
    evod::v1::Limits limits_;
    std::optional<Error> ended_; // why no request can be sent any more
    bool had_session_ = false;
    std::optional<Error> lost_; // why there is no session at present; nullopt: there is one, or there was none yet
    std::set<std::string> own_replays_;   // names of the replays that this session has opened
    std::set<std::string> ended_replays_; // names of the replays that earlier sessions have opened
    std::uint64_t last_id_ = 0;
    Entries pending_;
    // The ids of the requests that were sent in this session and have no reply. After a timeout, a request counts
    // towards the server's limit until its late reply arrives.
    std::set<std::uint64_t> in_flight_;
    std::set<std::uint64_t> abandoned_replays_; // ids of the unanswered OpenReplay requests that have timed out
    std::vector<Outcome> outcomes_;
};

} // namespace evod::core
