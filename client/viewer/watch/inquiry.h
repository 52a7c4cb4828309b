// Inquiry: something that is asked of the server now and again, one question at a time, and whose answers are believed
// only by who still wants them.
//
// An answer that comes when another place is looked at, when the inquiry was forgotten or asked again, or when it is no
// more, is dropped. One that has not come for long never will: then the question is asked again.
//
// Owner        who asks, a panel or the sight of a pane; it may die, or live on, before the answer comes.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/watch/watch.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace evod::viewer {

class Inquiry {
  public:
    using Clock = core::WorldView::Clock;
    /// Null: the question was refused, or nothing was heard; trouble() says why. May ask again, or say when.
    using Handler = std::function<void(const evod::v1::Response*)>;

    static constexpr std::chrono::seconds after_refusal{2}; // until it is asked again
    static constexpr std::chrono::seconds patience{15};     // longer than any answer takes

    /// pause  from an answer until the next question.
    explicit Inquiry(Clock::duration pause = {}) : pause_{pause} {}
    Inquiry(Inquiry&&) = default;
    Inquiry& operator=(Inquiry&&) = default;

    /// Whether it may be asked now: nothing is under way, and the pause is over. About another place than the last
    /// question it may be asked at once, and what was under way is forgotten.
    bool due(const Watch& watch, Clock::time_point now);
    /// Sends the question. An answer to the one before will be dropped.
    void ask(Watch& watch, evod::v1::Request request, Clock::time_point now, Handler handler);
    bool under_way() const { return state_->asked.has_value(); }

    /// The next question may be asked as soon as nothing is under way: what was told is out of date.
    void hurry() { state_->hurried = true; }
    /// The next question may be asked so long from now on.
    void wait(Clock::duration pause);
    /// Nothing was asked, and nothing is wrong.
    void forget();

    /// Why the last question was not answered, in a sentence; empty if it was.
    const std::string& trouble() const { return state_->trouble; }
    /// Whether that is because the server does not know the question: it will not tomorrow.
    bool is_unknown() const { return state_->unknown; }

  private:
    struct State {
        std::uint64_t number = 0;                 // of the last question; rises when it is forgotten, too
        std::uint64_t place = 0;                  // that it was about
        std::optional<Clock::time_point> asked{}; // and is unanswered
        Clock::time_point next{};
        bool hurried = false;
        std::string trouble{};
        bool unknown = false;
    };

    Clock::duration pause_;
    std::shared_ptr<State> state_ = std::make_shared<State>(); // an answer that finds it gone is nobody's
};

} // namespace evod::viewer
