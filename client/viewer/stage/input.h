// Input: keys and mouse → what is asked of the window.
//
// Which key does what is said in keys.h; held arrows and the mouse move the camera here.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/gui.h"
#include "client/viewer/stage/keys.h"

#include <SFML/Window/Event.hpp>

#include <optional>
#include <set>
#include <utility>

namespace evod::viewer {

class Input {
  public:
    /// Moves and zooms the camera at once; what else was asked is returned. A held key acts once, but for + − and
    /// steps.
    std::optional<Action> handle(const sf::Event& event, Captured captured, Camera& camera);

    /// Pans by the arrow keys that are held.
    void move(Camera& camera, double seconds) const;

    /// Where the mouse is, if it is in the window and not moving the picture.
    std::optional<Point> pointed_at() const { return dragging_ ? std::nullopt : mouse_; }

    /// Where a button was pressed and let go without moving the picture, once.
    std::optional<Point> take_click() { return std::exchange(clicked_, std::nullopt); }

  private:
    std::optional<Action> press(const sf::Event::KeyEvent& key);

    std::set<sf::Keyboard::Key> held_;
    std::optional<Point> mouse_;
    std::optional<Point> pressed_at_, clicked_;
    bool dragging_ = false;
};

} // namespace evod::viewer
