// Poll: sends one request to the server again and again, one at a time, and drops answers that are out of date.
//
// An answer is dropped if another world or island is shown meanwhile, if the poll was reset or has sent another request,
// or if the poll was destroyed. A request without an answer is sent again after `answer_timeout`.
//
// Owner        a panel, or the IslandView of a pane; it may be destroyed before the answer arrives.
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
    using Clock = core::WorldView::Clock;
    /// Null: the request was refused or not answered; problem() says why. May send the next request, or delay it.
    using Handler = std::function<void(const evod::v1::Response*)>;

    static constexpr std::chrono::seconds after_refusal{2};
    static constexpr std::chrono::seconds answer_timeout{15}; // longer than any answer takes

    /// interval  from an answer until the next request.
    explicit Poll(Clock::duration interval = {}) : interval_{interval} {}
    Poll(Poll&&) = default;
    Poll& operator=(Poll&&) = default;

    /// Whether a request may be sent now: none is pending, and the interval is over. If another world or island is shown
    /// than at the last request, it may be sent at once, and the pending request is forgotten.
    bool due(const ViewedWorld& world, Clock::time_point now);
    /// Sends a request. The answer to the one before is dropped.
    void send(ViewedWorld& world, evod::v1::Request request, Clock::time_point now, Handler handler);
    bool pending() const { return state_->sent.has_value(); }

    /// Makes the next request due as soon as none is pending: the last answer is out of date.
    void hurry() { state_->hurried = true; }
    /// Makes the next request due after `delay`.
    void wait(Clock::duration delay);
    /// Forgets the pending request and the problem.
    void reset();

    /// Why the last request was refused or not answered, as a sentence; empty if it was answered.
    const std::string& problem() const { return state_->problem; }
    /// Whether the server does not support the request: sending it again is of no use.
    bool is_unsupported() const { return state_->unsupported; }

  private:
    struct State {
        std::uint64_t number = 0;                // of the last request; a reset increments it, too
        std::uint64_t place = 0;                 // that the request was about (WorldFeed::place_number)
        std::optional<Clock::time_point> sent{}; // while an answer is pending
        Clock::time_point next{};
        bool hurried = false;
        std::string problem{};
        bool unsupported = false;
    };

    Clock::duration interval_;
    std::shared_ptr<State> state_ = std::make_shared<State>(); // handlers hold it weakly: gone with the poll
};

} // namespace evod::viewer
