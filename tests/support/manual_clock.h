// ManualClock: time stands still until a test moves it, or moves on a little with every look at it.
#pragma once

#include "server/runtime/clock.h"

namespace evod::support {

class ManualClock final : public runtime::Clock {
  public:
    time_point now() override {
        now_ += per_look;
        return now_;
    }
    void advance(duration passed) { now_ += passed; }

    duration per_look{0}; // what the work between two looks is said to take

  private:
    time_point now_{std::chrono::hours{1}};
};

} // namespace evod::support
