// Poll: sends requests of one kind to the server at intervals, one at a time, and drops outdated answers.
//
// An answer is dropped in these cases: another world or island is shown meanwhile; the poll was reset or has sent
// another request; the poll was destroyed. A request without an answer is sent again after `answer_timeout`.
//
// Owner        a panel, or IslandData; the Poll may be destroyed before the answer arrives.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/world/viewed_world.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace evod::viewer {

class Poll {
  public:
    using Clock = core::SnapshotInterpolator::Clock;
    /// A function that receives the answer. Null: the request was refused or not answered; problem() contains the
    /// reason. A handler may send the next request or delay it.
    using Handler = std::function<void(const evod::v1::Response*)>;

    static constexpr std::chrono::seconds after_refusal{2};
    static constexpr std::chrono::seconds answer_timeout{15}; // longer than any answer takes

    /// interval  time from an answer until the next request is due.
    explicit Poll(Clock::duration interval = {}) : interval_{interval} {}
    Poll(Poll&&) = default;
    Poll& operator=(Poll&&) = default;

    /// Returns whether a request may be sent now: the interval is over, and no request is pending. If another world or
    /// island is shown than at the last request, a request may be sent at once, and the pending one is forgotten.
    bool due(const ViewedWorld& world, Clock::time_point now);
    /// Sends a request. The answer to any earlier request will be dropped.
    void send(ViewedWorld& world, evod::v1::Request request, Clock::time_point now, Handler handler);
    bool pending() const { return state_->sent.has_value(); }

    /// Makes the next request due as soon as no request is pending. Call when the last answer is outdated.
    void make_due() { state_->due_now = true; }
    /// Makes the next request due after `delay`.
    void wait(Clock::duration delay);
    /// Forgets the pending request and the problem.
    void reset();

    /// Returns why the last request was refused or not answered, as a sentence; empty if it was answered.
    const std::string& problem() const { return state_->problem; }
    /// Returns whether the server does not support this request, or stores no runs that it could read for the answer.
    /// Sending it again would be useless.
    bool is_unsupported() const { return state_->unsupported; }

  private:
    struct State {
        std::uint64_t number = 0;                // number of the last request; reset() also increments it
        std::uint64_t place = 0;                 // the place that the request is about (WorldFeed::place_number)
        std::optional<Clock::time_point> sent{}; // nullopt: no answer is pending
        Clock::time_point next{};
        bool due_now = false;
        std::string problem{};
        bool unsupported = false;
    };

    Clock::duration interval_;
    std::shared_ptr<State> state_ =
        std::make_shared<State>(); // handlers hold weak references, so it is destroyed with the Poll
};

} // namespace evod::viewer
