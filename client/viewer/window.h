// Window: worlds, live, and the keys that command the one with the focus.
//
// Owner        main.
// Threads      used by the thread that made it, which draws; the connection of each Watch has its own.
#pragma once

#include "client/viewer/input.h"
#include "client/viewer/options.h"
#include "client/viewer/pane.h"
#include "client/viewer/stage.h"

#include <SFML/Window/ContextSettings.hpp>
#include <SFML/Window/Window.hpp>

namespace evod::viewer {

/// What the drawing needs.
sf::ContextSettings context_settings();

class Window {
  public:
    /// Throws std::runtime_error if it cannot be opened.
    explicit Window(const Options& options);

    /// Until it is closed.
    void run();

  private:
    void handle_events();
    void carry_out(Action action);
    void look_at_past_or_present();
    void save_screenshot();
    Stage::Frame frame() const;

    sf::Window window_;
    Stage stage_; // after the window, whose OpenGL it needs
    Panes panes_;
    Input input_;
    link::WorldView::Clock::time_point now_{};
};

} // namespace evod::viewer
