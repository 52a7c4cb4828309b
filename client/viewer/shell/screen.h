// Screen: the window on the desktop and the renderer that draws in it, from the start of evoview to its end. It shows the
// start screen or worlds. It is the source of events, those of a script and those of a person.
//
// Owner        run().
// Threads      used by the thread that made it.
#pragma once

#include "client/viewer/panes/window_renderer.h"
#include "client/viewer/shell/options.h"
#include "client/viewer/shell/script.h"

#include <SFML/Window/ContextSettings.hpp>
#include <SFML/Window/Window.hpp>

#include <deque>
#include <functional>
#include <string>

namespace evod::viewer {

/// The OpenGL version that drawing needs.
sf::ContextSettings context_settings();

class Screen {
  public:
    using Clock = core::WorldView::Clock;

    /// Throws std::runtime_error if the window cannot be opened.
    explicit Screen(const Options& options);

    /// Takes the next event and passes it to the widgets.
    bool poll(sf::Event& event);

    /// A frame of the window's current size, for drawing at this time.
    WindowRenderer::Frame frame(Clock::time_point now) const;

    /// Draws and shows a frame, runs the next step of the script, and waits until the next frame is due.
    ///
    /// world   null: the start screen is shown
    /// draw    draws the frame; called again for a screenshot
    /// Throws std::runtime_error, with the line, if a step of the script fails.
    void show(const ViewedWorld* world, const WindowRenderer::Frame& frame, const std::function<void()>& draw);

    sf::Window& window() { return window_; }
    WindowRenderer& renderer() { return renderer_; }

  private:
    class ScriptHost;
    void advance_script(ScriptHost& host, Clock::time_point now);

    sf::Window window_;
    WindowRenderer renderer_; // after window_, whose OpenGL context it needs
    Script script_;
    std::string script_path_;
    std::deque<sf::Event> script_events_;
    unsigned settled_count_ = 0; // frames since the last event of the script
};

} // namespace evod::viewer
