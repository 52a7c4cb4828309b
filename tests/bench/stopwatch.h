// Stopwatch: how long something took, by the clock on the wall and by the processor time of all threads.
#pragma once

#include <time.h>

namespace evod::bench {

struct Seconds {
    double wall = 0, processor = 0;
};

class Stopwatch {
  public:
    /// Since this was made.
    Seconds elapsed() const { return {now(CLOCK_MONOTONIC) - wall_, now(CLOCK_PROCESS_CPUTIME_ID) - processor_}; }

  private:
    static double now(clockid_t clock) {
        timespec time{};
        clock_gettime(clock, &time);
        return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
    }
    double wall_ = now(CLOCK_MONOTONIC), processor_ = now(CLOCK_PROCESS_CPUTIME_ID);
};

} // namespace evod::bench
