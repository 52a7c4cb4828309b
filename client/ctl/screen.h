// Screen: what is drawn again and again over itself, and news of the connection meanwhile.
#pragma once

#include "client/link/connection.h"

#include <cstddef>
#include <string>

namespace evod::ctl {

struct TerminalSize {
    std::size_t columns = 80, lines = 24; // where there is no terminal to ask
};
TerminalSize terminal_size();

/// Whole lines that take the place of those drawn before.
class Drawing {
  public:
    void draw(const std::string& text);

  private:
    std::ptrdiff_t lines_ = 0;
};

/// Says on stderr when the connection is lost; throws Stop when it has failed for good.
class ConnectionNews {
  public:
    void tell(const link::Connection& connection);

  private:
    bool lost_ = false;
};

} // namespace evod::ctl
