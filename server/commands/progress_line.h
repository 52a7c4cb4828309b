// Progress line: one line on a terminal's stderr that is overwritten, at most ten times a second; elsewhere nothing.
#pragma once

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <string>

namespace evod::commands {

class ProgressLine {
  public:
    /// text  called for what to say if it is time to say something.
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
/// share  in (0, 1]: how much of the work the seconds that are gone have been enough for
std::string time_left(double share, double seconds_gone);

} // namespace evod::commands
