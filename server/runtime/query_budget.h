// Query budget: how much time the simulation thread spends on queries while worlds run.
//
// Queries earn a share of the time that passes, and save some of it for a burst. A query that takes longer than what
// was saved is paid for before the next one begins. So clients that ask all the time cost a world at most that share.
//
// Owner        the simulation loop; used by its thread.
// Determinism  decides when a query is answered, never what a world does.
#pragma once

#include "server/runtime/clock.h"

#include <algorithm>

namespace evod::runtime {

class QueryBudget {
  public:
    static constexpr int share = 10; // one part in so many of the time
    static constexpr std::chrono::milliseconds saved_max{5};

    /// Whether a query may begin at `now`, which never goes back.
    bool allows(Clock::time_point now) {
        earn(now);
        return saved_ > Clock::duration::zero();
    }
    void spend(Clock::duration time) { saved_ -= time; }

    /// When the next query may begin if nothing more is spent. After a call of allows().
    Clock::time_point next_at() const {
        return earned_until_ + std::max(Clock::duration{1} - saved_, Clock::duration::zero()) * share;
    }

  private:
    void earn(Clock::time_point now) {
        saved_ = std::min<Clock::duration>(saved_ + (now - earned_until_) / share, saved_max);
        earned_until_ = now;
    }

    Clock::time_point earned_until_; // the clock's beginning: at first all is saved that can be
    Clock::duration saved_{0};       // below 0: is still to be paid for
};

} // namespace evod::runtime
