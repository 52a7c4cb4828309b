// Query budget: limits the time that the simulation thread spends on queries while worlds run.
//
// The budget grows by a fixed share of the elapsed time, up to a small maximum for bursts. A query that takes longer
// than the budget leaves a debt. The next query waits until the debt is paid. So queries slow a world by at most that
// share, even if clients send them without pause.
//
// Owner        the simulation loop, on its thread.
// Determinism  the budget decides when a query is answered. It does not influence what a world does.
#pragma once

#include "server/runtime/clock.h"

#include <algorithm>

namespace evod::runtime {

class QueryBudget {
  public:
    static constexpr int share = 10; // queries get 1 / share of the elapsed time
    static constexpr std::chrono::milliseconds saved_max{5};

    /// Whether a query may start at the time `now`. Times must not decrease between calls.
    bool allows(Clock::time_point now) {
        earn(now);
        return saved_ > Clock::duration::zero();
    }
    void spend(Clock::duration time) { saved_ -= time; }

    /// The earliest time at which the next query may start. allows() must be called first.
    Clock::time_point next_query_at() const {
        return earned_until_ + std::max(Clock::duration{1} - saved_, Clock::duration::zero()) * share;
    }

  private:
    void earn(Clock::time_point now) {
        saved_ = std::min<Clock::duration>(saved_ + (now - earned_until_) / share, saved_max);
        earned_until_ = now;
    }

    Clock::time_point earned_until_; // initially the clock's epoch, so that the budget starts full
    Clock::duration saved_{0};       // negative: a debt
};

} // namespace evod::runtime
