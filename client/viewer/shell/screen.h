// Screen: the window on the desktop and what draws in it, for as long as evoview runs. The start screen and the worlds
// take turns in it. Events come from here: a script's as well as a person's.
//
// Owner        run().
// Threads      used by the thread that made it.
#pragma once

#include "client/viewer/shell/options.h"
#include "client/viewer/shell/script.h"
#include "client/viewer/stage/stage.h"

#include <SFML/Window/ContextSettings.hpp>
#include <SFML/Window/Window.hpp>

#include <deque>
#include <functional>
#include <string>

namespace evod::viewer {

/// What the drawing needs.
sf::ContextSettings context_settings();

class Screen {
  public:
    using Clock = core::WorldView::Clock;

    /// Throws std::runtime_error if the window cannot be opened.
    explicit Screen(const Options& options);

    /// The next event. The stage's widgets have been given it.
    bool poll(sf::Event& event);

    /// The window as it is, to be drawn at this moment.
    Stage::Frame frame(Clock::time_point now) const;

    /// Draws, shows it, takes the script a step further, and waits for the next frame.
    ///
    /// watch   null: nothing is watched
    /// draw    what there is to be drawn; called again for a screenshot
    /// Throws std::runtime_error if the script cannot go on; it names the line.
    void show(const Watch* watch, const Stage::Frame& frame, const std::function<void()>& draw);

    sf::Window& window() { return window_; }
    Stage& stage() { return stage_; }

  private:
    class Hands;
    void advance_script(Hands& hands, Clock::time_point now);

    sf::Window window_;
    Stage stage_; // after the window, whose OpenGL it needs
    Script script_;
    std::string script_path_;
    std::deque<sf::Event> played_;
    unsigned settled_count_ = 0; // frames since the last event was given to the widgets
};

} // namespace evod::viewer
