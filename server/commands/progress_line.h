// Progress line: one line on stderr. Each update overwrites it, at most ten times a second. If stderr is not a
// terminal, nothing is printed. With --json, each update is a line on stdout (json_lines.h).
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
    explicit ProgressLine(bool json = false) : json_{json} {}

    /// share  finished share of the work, 0 to 1; printed with --json.
    /// text   returns the line, as for the other show(); printed on a terminal.
    template <class Text>
    void show(double share, Text&& text) {
        if (!json_) {
            show(text);
        } else if (is_due()) {
            print_share(share);
        }
    }
    /// text  a function that returns the line. show() calls it only if 100 ms have passed since the last update.
    template <class Text>
    void show(Text&& text) {
        if (on_terminal_ && !json_ && is_due()) {
            std::fprintf(stderr, "\r%s \x1b[K", std::string{text()}.c_str());
        }
    }
    void clear() const {
        if (on_terminal_ && !json_) {
            std::fprintf(stderr, "\r\x1b[K");
        }
    }

  private:
    using Clock = std::chrono::steady_clock;
    /// Whether 100 ms have passed since the last time that it returned true.
    bool is_due() {
        const bool is_due = Clock::now() - shown_ >= std::chrono::milliseconds{100};
        shown_ = is_due ? Clock::now() : shown_;
        return is_due;
    }
    static void print_share(double share);

    bool json_;
    bool on_terminal_ = isatty(STDERR_FILENO) != 0;
    Clock::time_point shown_{};
};

/// Formats the estimated remaining time: "90 s left", "37 min left", "2 h 05 min left".
///
/// share         finished share of the work, in (0, 1].
/// seconds_gone  time that this share of the work took.
std::string time_left(double share, double seconds_gone);

} // namespace evod::commands
