// Window: shows worlds until the user closes it, and performs the actions of the user's keys.
//
// Owner        run().
// Threads      used by the thread that draws; the connection of each world has its own thread.
#pragma once

#include "client/viewer/panes/input.h"
#include "client/viewer/panes/pane.h"
#include "client/viewer/shell/options.h"
#include "client/viewer/shell/screen.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace evod::viewer {

class Window {
  public:
    struct Ending {
        bool to_start_screen = false; // return to the start screen; false: evoview ends
        std::string reason;           // why there is no connection; empty: the user chose to return
    };

    Window(Screen& screen, const Options& options);
    /// Stores how the island is shown, unless the command line set its look.
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// Shows worlds until the user closes the window or evoview must return to the start screen.
    ///
    /// must_connect  if the first attempt to connect fails, return with the reason; false: retry
    /// connected     is called when the first connection is established
    Ending run(bool must_connect, const std::function<void()>& connected);

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
    Panes panes_;
    bool stores_view_;
    Input input_;
    std::optional<std::uint32_t> pressed_organism_; // the organism under the mouse when the button was pressed
    core::SnapshotInterpolator::Clock::time_point now_{};
    core::SnapshotInterpolator::Clock::time_point
        asked_to_quit_{}; // time of the first Esc; a second Esc soon after it quits
    bool to_start_screen_ = false;
};

} // namespace evod::viewer
