// Input: translates key and mouse events into actions of the window, and moves the camera.
//
// The table in keys.h assigns actions to keys.
//
// Owner        Window.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/gui.h"
#include "client/viewer/view/keys.h"

#include <SFML/Window/Event.hpp>

#include <optional>
#include <set>
#include <utility>

namespace evod::viewer {

class Input {
  public:
    /// Handles an event. Pans and zooms the camera directly and returns any other action. While a key is held down, its
    /// action is returned once; only + − and the step keys repeat.
    std::optional<Action> handle(const sf::Event& event, Captured captured, Camera& camera);

    /// Returns whether the event presses a key that moves the camera while it is held down.
    static bool moves_camera(const sf::Event& event);

    /// Pans the camera in the direction of the arrow keys that are held down.
    void move(Camera& camera, double seconds) const;

    /// Returns the position of the mouse; nullopt while the mouse is outside the window or drags.
    std::optional<Point> pointed_at() const { return dragging_ ? std::nullopt : mouse_; }

    /// Returns the position of a click since the last call; nullopt if there was none. A click is a press and release
    /// without a drag.
    std::optional<Point> take_click() { return std::exchange(clicked_, std::nullopt); }

  private:
    std::optional<Action> press(const sf::Event::KeyEvent& key);

    std::set<sf::Keyboard::Key> held_;
    std::optional<Point> mouse_;
    std::optional<Point> pressed_at_, clicked_;
    bool dragging_ = false;
};

} // namespace evod::viewer
