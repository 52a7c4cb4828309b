// Rate limit: a token bucket, with an average rate and a maximum burst.
//
// Owner        a session, which limits the rate of its client's frames.
#pragma once

#include "server/runtime/clock.h"

#include <algorithm>

namespace evod::network {

class RateLimit {
  public:
    using Clock = runtime::Clock;

    /// per_s  tokens added per second, > 0.
    /// burst  capacity and initial number of tokens, >= 1.
    RateLimit(double per_s, double burst, Clock::time_point now)
        : per_s_{per_s}, burst_{burst}, tokens_{burst}, filled_{now} {}

    /// Takes this number of tokens. A request for more than `burst` tokens takes the whole burst and leaves a debt.
    /// Returns false if there are too few tokens; none is taken then.
    bool take(double tokens, Clock::time_point now) {
        tokens_ = std::min(burst_, tokens_ + per_s_ * std::chrono::duration<double>{now - filled_}.count());
        filled_ = now;
        if (tokens_ < std::min(tokens, burst_)) {
            return false;
        }
        tokens_ -= tokens;
        return true;
    }
    /// Takes tokens even if there are too few, which leaves a debt.
    void charge(double tokens) { tokens_ -= tokens; }

    /// The time until this number of tokens is available. A waiting session should wait for several tokens at once.
    Clock::duration time_for(double tokens) const {
        return std::chrono::ceil<Clock::duration>(std::chrono::duration<double>{tokens / per_s_});
    }

  private:
    double per_s_, burst_, tokens_;
    Clock::time_point filled_;
};

} // namespace evod::network
