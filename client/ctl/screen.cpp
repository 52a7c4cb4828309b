#include "client/ctl/screen.h"

#include "client/ctl/stop.h"
#include "client/ctl/text.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>

namespace evod::ctl {

TerminalSize terminal_size() {
    winsize size{};
    if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) {
        return {};
    }
    return {size.ws_col, size.ws_row};
}

void Drawing::draw(const std::string& text) {
    const std::string clipped = clip_lines(text, terminal_size().columns);
    // Up over the last drawing, and everything below goes.
    std::cout << (lines_ > 0 ? "\033[" + std::to_string(lines_) + "A" : "") << "\r\033[J" << clipped << std::flush;
    lines_ = std::ranges::count(clipped, '\n');
}

void ConnectionNews::tell(const link::Connection& connection) {
    const auto status = connection.status();
    if (status.state == link::State::Failed) {
        throw Stop{ExitCode::NoConnection, status.reason};
    }
    const bool lost = status.state != link::State::Connected;
    if (lost && !lost_) {
        std::cerr << status.reason << "; trying again\n";
    }
    lost_ = lost;
}

} // namespace evod::ctl
