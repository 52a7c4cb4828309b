// Screen: redraws text in place on a terminal, and reports changes of the connection.
#pragma once

#include "client/core/connection.h"

#include <cstddef>
#include <string>

namespace evod::ctl {

struct TerminalSize {
    std::size_t columns = 80, lines = 24; // these defaults apply if there is no terminal
    bool operator==(const TerminalSize&) const = default;
};
TerminalSize terminal_size();

/// A text on the terminal that each draw() replaces. It consists of whole lines.
class LiveText {
  public:
    /// Replaces the previous text. Cuts text that does not fit into the width and height of the terminal.
    void draw(const std::string& text);
    /// Keeps the current text on the terminal; the next draw() starts below it.
    void leave();
    ~LiveText() { leave(); }

  private:
    std::ptrdiff_t lines_ = 0;
    bool ends_line_ = true; // whether the text drawn last ends with a line break
    TerminalSize size_;
};

/// Reports on stderr that the connection was lost; throws Stop if the client will not reconnect.
class ConnectionReporter {
  public:
    /// live_text  the text on the terminal; the message is printed below it.
    void report(const core::Connection& connection, LiveText& live_text);

  private:
    bool lost_ = false;
};

} // namespace evod::ctl
