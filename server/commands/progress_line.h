// Progress line: one line on stderr. Each update overwrites it, at most ten times a second. If stderr is not a
// terminal, nothing is printed.
//
// Threads  one thread at a time; several threads must use a lock.
#pragma once

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <string>

namespace evod::commands {

class ProgressLine {
  public:
    /// text  a function that returns the line. show() calls it only if 100 ms have passed since the last update.
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

/// Formats the estimated remaining time: "90 s left", "37 min left", "2 h 05 min left".
///
/// share         finished share of the work, in (0, 1].
/// seconds_gone  time that this share of the work took.
std::string time_left(double share, double seconds_gone);

} // namespace evod::commands
