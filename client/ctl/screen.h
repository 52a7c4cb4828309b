// Screen: what is drawn again and again over itself, and news of the connection meanwhile.
#pragma once

#include "client/core/connection.h"

#include <cstddef>
#include <string>

namespace evod::ctl {

struct TerminalSize {
    std::size_t columns = 80, lines = 24; // where there is no terminal to ask
    bool operator==(const TerminalSize&) const = default;
};
TerminalSize terminal_size();

/// Whole lines that take the place of those drawn before.
class Drawing {
  public:
    /// What does not fit on the screen as it is now is left out, at the right and below.
    void draw(const std::string& text);
    /// It stays: something else is to be written below, and the next is drawn under that.
    void leave();
    ~Drawing() { leave(); }

  private:
    std::ptrdiff_t lines_ = 0;
    bool ends_line_ = true; // what was drawn last
    TerminalSize size_;
};

/// Says on stderr when the connection is lost; throws Stop when it has failed for good.
class ConnectionNews {
  public:
    /// drawing  that is on the screen meanwhile, and makes way.
    void tell(const core::Connection& connection, Drawing& drawing);

  private:
    bool lost_ = false;
};

} // namespace evod::ctl
