#include "client/ctl/screen.h"

#include "client/ctl/stop.h"
#include "client/ctl/text.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <utility>

namespace evod::ctl {

TerminalSize terminal_size() {
    winsize size{};
    if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) {
        return {};
    }
    return {size.ws_col, size.ws_row};
}

void LiveText::draw(const std::string& text) {
    const TerminalSize size = terminal_size();
    const std::string clipped = clip_page(text, size.columns, size.lines);
    // Moves the cursor to the start of the last drawn text and clears everything below. If the size of the terminal has
    // changed, lines may have wrapped differently, so the start of the last drawn text is unknown.
    const bool moved = lines_ > 0 && size != size_;
    std::cout << (moved        ? "\033[H"
                  : lines_ > 0 ? "\033[" + std::to_string(lines_) + "A"
                               : "")
              << "\r\033[J" << clipped << std::flush;
    size_ = size;
    ends_line_ = clipped.empty() || clipped.ends_with('\n');
    lines_ = std::ranges::count(clipped, '\n');
}

void LiveText::leave() {
    if (!std::exchange(ends_line_, true)) {
        std::cout << '\n' << std::flush;
    }
    lines_ = 0;
}

void ConnectionReporter::report(const core::Connection& connection, LiveText& live_text) {
    const auto status = connection.status();
    if (status.state == core::State::Failed) {
        live_text.leave();
        throw Stop{ExitCode::NoConnection, status.reason};
    }
    const bool lost = status.state != core::State::Connected;
    if (lost && !lost_) {
        live_text.leave();
        std::cerr << visible(status.reason) << "; reconnecting\n";
    }
    lost_ = lost;
}

} // namespace evod::ctl
