// Screen: the window on the desktop and the renderer that draws in it, from the start of evoview to its end. It shows
// the start screen or worlds. It supplies the events of the user and of a script.
//
// Owner        run().
// Threads      used by the thread that created it.
#pragma once

#include "client/viewer/panes/window_renderer.h"
#include "client/viewer/shell/options.h"
#include "client/viewer/shell/script.h"
#include "client/viewer/shell/settings.h"

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
    using Clock = core::SnapshotInterpolator::Clock;

    /// Throws std::runtime_error if the window cannot be opened.
    explicit Screen(const Options& options);

    /// Removes the next event from the queue and passes it to the widgets. Returns false if there is no event.
    bool poll(sf::Event& event);

    /// The data for drawing a frame at this time, in the window's current size.
    WindowRenderer::Frame frame(Clock::time_point now) const;

    /// Draws and shows a frame, runs the next step of the script, and waits until the next frame is due.
    ///
    /// world   the viewed world; null while the start screen is shown
    /// draw    draws the frame; is called again if the script takes a screenshot
    /// Throws std::runtime_error with the script line if a step of the script fails.
    void show(const ViewedWorld* world, const WindowRenderer::Frame& frame, const std::function<void()>& draw);

    sf::Window& window() { return window_; }
    WindowRenderer& renderer() { return renderer_; }
    /// The view options that the next window and the next start of evoview use.
    ViewOptions& stored_view() { return settings_.view(); }

  private:
    class ScriptHost;
    void advance_script(ScriptHost& host, Clock::time_point now);

    sf::Window window_;
    WindowRenderer renderer_; // declared after window_, because it needs the OpenGL context of the window
    Settings settings_;       // declared after renderer_, whose panels it stores
    Script script_;
    std::string script_path_;
    std::deque<sf::Event> script_events_;
    unsigned settled_count_ = 0; // frames since the script's last event was processed
};

} // namespace evod::viewer
