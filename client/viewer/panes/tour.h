// Tour: a few callouts that explain the window to a new user, one after another, each beside the widget that it is
// about. evoview shows it once, at its first start; the help shows it again.
//
// Owner        Overlay.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/drawing/gui.h"

#include <SFML/Window/Keyboard.hpp>

#include <cstddef>
#include <optional>

namespace evod::viewer {

class Tour {
  public:
    void start() { step_ = 0; }
    bool shown() const { return step_.has_value(); }
    void skip() { step_.reset(); }

    /// → and Enter show the next callout, ← the previous one, Esc ends the tour. Returns false for other keys, and
    /// while the tour is not shown.
    bool handle(sf::Keyboard::Key key);

    /// Draws the current callout. Call between Gui::begin() and Gui::draw().
    ///
    /// worlds  the part of the window in which the worlds are drawn
    void build(const Gui& gui, Rectangle worlds);

  private:
    void next();
    void back();

    std::optional<std::size_t> step_; // nullopt: not shown
};

} // namespace evod::viewer
