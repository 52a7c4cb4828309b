// Window: shows a world until the user closes it, and performs the actions of the user's keys.
//
// Owner        main().
// Threads      used by the thread that draws; the connection of each world has its own thread.
#pragma once

#include "client/viewer/shell/options.h"
#include "client/viewer/shell/screen.h"
#include "client/viewer/view/input.h"
#include "client/viewer/view/world_view.h"

#include <cstdint>
#include <optional>
#include <string>

namespace evod::viewer {

class Window {
  public:
    Window(Screen& screen, const Options& options);

    /// Shows the world until the user closes the window. Connects again whenever the connection is lost.
    void run();

  private:
    void handle_events();
    /// Returns why this action would have no effect now; empty if it would have one.
    std::string problem_of(Action action);
    void carry_out(Action action);
    void close_front();
    /// Puts the link to the shown moment on the clipboard.
    void copy_link();
    void save_screenshot();

    Screen& screen_;
    sf::Window& window_;
    WindowRenderer& renderer_;
    WorldView view_;
    Input input_;
    std::optional<std::uint32_t> pressed_organism_; // the organism under the mouse when the button was pressed
    core::SnapshotInterpolator::Clock::time_point now_{};
    core::SnapshotInterpolator::Clock::time_point
        asked_to_quit_{}; // time of the first Esc; a second Esc soon after it quits
};

} // namespace evod::viewer
