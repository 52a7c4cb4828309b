// Query budget: bounds the time that the simulation thread spends on queries while worlds run.
//
// The budget grows by a fixed share of the elapsed time, up to a small maximum for bursts. A query that takes longer
// than the budget leaves a debt, and the next one waits until it is paid. So even clients that query without pause slow
// a world by at most that share.
//
// Owner        the simulation loop, on its thread.
// Determinism  decides when a query is answered, never what a world does.
#pragma once

#include "server/runtime/clock.h"

#include <algorithm>

namespace evod::runtime {

class QueryBudget {
  public:
    static constexpr int share = 10; // one part in `share` of the elapsed time
    static constexpr std::chrono::milliseconds saved_max{5};

    /// Whether a query may start at `now`. Times must not decrease.
    bool allows(Clock::time_point now) {
        earn(now);
        return saved_ > Clock::duration::zero();
    }
    void spend(Clock::duration time) { saved_ -= time; }

    /// When the next query may start if no more time is spent. Call allows() first.
    Clock::time_point next_at() const {
        return earned_until_ + std::max(Clock::duration{1} - saved_, Clock::duration::zero()) * share;
    }

  private:
    void earn(Clock::time_point now) {
        saved_ = std::min<Clock::duration>(saved_ + (now - earned_until_) / share, saved_max);
        earned_until_ = now;
    }

    Clock::time_point earned_until_; // starts at the clock's epoch, so the budget is full at first
    Clock::duration saved_{0};       // negative: debt
};

} // namespace evod::runtime
