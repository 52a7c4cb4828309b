// ForkDialog: a button that creates a world from the moment that a world shows, and the dialog that asks for its name.
//
// Owner        Summary.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/world/viewed_world.h"

#include <array>

namespace evod::viewer {

class ForkDialog {
  public:
    void build(ViewedWorld& world);

  private:
    std::array<char, 65> name_{};
};

} // namespace evod::viewer
