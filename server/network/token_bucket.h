// Token bucket: how many things may be done in the long run, and how many at once.
//
// Owner        a session, for what its client sends.
#pragma once

#include "server/runtime/clock.h"

#include <algorithm>

namespace evod::network {

class TokenBucket {
  public:
    using Clock = runtime::Clock;

    /// per_s  tokens that come in a second, > 0.
    /// burst  tokens that it holds, and has at first, >= 1.
    TokenBucket(double per_s, double burst, Clock::time_point now)
        : per_s_{per_s}, burst_{burst}, tokens_{burst}, filled_{now} {}

    /// Takes so many tokens, or the whole burst for more than that and the rest of those that come; false: there are
    /// not as many, and none was taken.
    bool take(double tokens, Clock::time_point now) {
        tokens_ = std::min(burst_, tokens_ + per_s_ * std::chrono::duration<double>{now - filled_}.count());
        filled_ = now;
        if (tokens_ < std::min(tokens, burst_)) {
            return false;
        }
        tokens_ -= tokens;
        return true;
    }
    /// Takes them whether they are there or not.
    void charge(double tokens) { tokens_ -= tokens; }

    /// How long it takes for so many to come. Whoever has to wait had better wait for a few, not for one at a time.
    Clock::duration time_for(double tokens) const {
        return std::chrono::ceil<Clock::duration>(std::chrono::duration<double>{tokens / per_s_});
    }

  private:
    double per_s_, burst_, tokens_;
    Clock::time_point filled_;
};

} // namespace evod::network
