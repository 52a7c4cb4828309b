// Screen: the window on the desktop and the renderer that draws in it, from the start of evoview to its end. It
// supplies the events of the user and of a script.
//
// Owner        main().
// Threads      used by the thread that created it.
#pragma once

#include "client/viewer/shell/options.h"
#include "client/viewer/shell/script.h"
#include "client/viewer/view/window_renderer.h"

#include <SFML/Window/ContextSettings.hpp>
#include <SFML/Window/Window.hpp>

#include <chrono>
#include <deque>
#include <string>

namespace evod::viewer {

/// The OpenGL version that drawing needs.
sf::ContextSettings context_settings();

class Screen {
  public:
    using Clock = core::SnapshotInterpolator::Clock;

    /// Vertical sync limits the frame rate. For displays without vertical sync, a frame takes at least this long. The
    /// limit is short enough not to miss a frame at 60 Hz.
    static constexpr std::chrono::milliseconds frame_min{15};

    /// Throws std::runtime_error if the window cannot be opened.
    explicit Screen(const Options& options);

    /// Removes the next event from the queue and passes it to the widgets. Returns false if there is no event.
    bool poll(sf::Event& event);

    /// The data for drawing a frame at this time, in the window's current size.
    WindowRenderer::Frame frame(Clock::time_point now) const;

    /// Draws and shows a frame, runs the next step of the script, and waits until the next frame is due.
    ///
    /// Throws std::runtime_error with the script line if a step of the script fails.
    void show(WorldView& view, const WindowRenderer::Frame& frame);

    /// Call after an event of a key has been handled. If the key came from the script and had no effect, the script
    /// fails.
    ///
    /// problem  why the key had no effect; empty if it had one
    void report_key(std::string problem);

    sf::Window& window() { return window_; }
    WindowRenderer& renderer() { return renderer_; }

  private:
    class ScriptHost;
    void advance_script(ScriptHost& host, Clock::time_point now);

    sf::Window window_;
    WindowRenderer renderer_; // declared after window_, because it needs the OpenGL context of the window
    Script script_;
    std::string script_path_;
    std::deque<sf::Event> script_events_;
    bool event_from_script_ = false; // whether poll() has returned an event of the script
    std::string key_problem_;        // why the last key of the script had no effect
    unsigned settled_count_ = 0;     // frames since the script's last event was processed
};

} // namespace evod::viewer
