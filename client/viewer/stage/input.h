// Input: keys and mouse → what is asked of the window.
//
// One table says which key does what, and the help is drawn from it. Signs (+ − . >) are taken as text, so that they
// are found wherever a keyboard layout has them; everything else by key.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/gui.h"

#include <SFML/Window/Event.hpp>

#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace evod::viewer {

enum class Action {
    PauseOrResume,
    StepOne,
    StepMany,
    Faster,
    Slower,
    RealTime,
    MaxSpeed,
    NextIsland,
    PreviousIsland,
    NextWorld,
    PastOrPresent,
    PreviousGeneration,
    NextGeneration,
    Beside,
    OtherHalf,
    LinkCameras,
    AllIslands,
    Fit,
    Screenshot,
    NextColouring,
    Radii,
    Forces,
    Trails,
    Follow,
    Start, // to the start screen
    Help,
    Close, // the help, or else the panel in front, or else the window
    Quit,
    FirstPanel, // and from here on the panels after it, by index
};

/// Which panel is to be shown or hidden; nullopt if that is not what the action says.
std::optional<std::size_t> panel_of(Action action);

constexpr unsigned step_many_ticks = 60;

/// A line of the help.
struct HelpLine {
    std::string_view keys, text;
};
std::span<const HelpLine> help_lines();

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
