// Screen: redraws text in place on a terminal, and reports changes of the connection.
#pragma once

#include "client/core/connection.h"

#include <cstddef>
#include <string>

namespace evod::ctl {

struct TerminalSize {
    std::size_t columns = 80, lines = 24; // used without a terminal
    bool operator==(const TerminalSize&) const = default;
};
TerminalSize terminal_size();

/// Text of whole lines that each draw() replaces.
class Drawing {
  public:
    /// Replaces the previous text. Text beyond the right and lower edge of the terminal is cut.
    void draw(const std::string& text);
    /// Keeps the current text on the terminal; the next draw() starts below it.
    void leave();
    ~Drawing() { leave(); }

  private:
    std::ptrdiff_t lines_ = 0;
    bool ends_line_ = true; // whether the last drawing did
    TerminalSize size_;
};

/// Reports a lost connection on stderr; throws Stop if it has failed for good.
class ConnectionNews {
  public:
    /// drawing  the text on the screen, which is kept above the message.
    void report(const core::Connection& connection, Drawing& drawing);

  private:
    bool lost_ = false;
};

} // namespace evod::ctl
