// Progress line: one line on stderr that each update overwrites, at most ten times a second. Where stderr is not a
// terminal, it prints nothing.
//
// Threads  one at a time; callers on several threads hold a lock.
#pragma once

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <string>

namespace evod::commands {

class ProgressLine {
  public:
    /// text  returns the line; show() calls it only if 100 ms have passed since the last update.
    template <class Text>
    void show(Text&& text) {
        if (!on_terminal_ || Clock::now() - shown_ < std::chrono::milliseconds{100}) {
            return;
        }
        shown_ = Clock::now();
        std::fprintf(stderr, "\r%s \x1b[K", std::string{text()}.c_str());
    }
    void clear() const {
        if (on_terminal_) {
            std::fprintf(stderr, "\r\x1b[K");
        }
    }

  private:
    using Clock = std::chrono::steady_clock;
    bool on_terminal_ = isatty(STDERR_FILENO) != 0;
    Clock::time_point shown_{};
};

/// "90 s left", "37 min left", "2 h 05 min left".
/// share         part of the work that is done, in (0, 1].
/// seconds_gone  time that this part took.
std::string time_left(double share, double seconds_gone);

} // namespace evod::commands
