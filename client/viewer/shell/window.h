// Window: shows worlds until it is closed, and carries out the keys of a person.
//
// Owner        run().
// Threads      used by the thread that draws; the connection of each world has its own.
#pragma once

#include "client/viewer/panes/input.h"
#include "client/viewer/panes/pane.h"
#include "client/viewer/shell/options.h"
#include "client/viewer/shell/screen.h"

#include <functional>
#include <string>

namespace evod::viewer {

class Window {
  public:
    struct Ending {
        bool to_start_screen = false; // else evoview ends
        std::string reason;           // why there is no connection; empty: a person chose the start screen
    };

    Window(Screen& screen, const Options& options);

    /// Returns when the window is closed or left for the start screen.
    ///
    /// must_connect  return, with the reason, if the first attempt to connect fails; else retry
    /// connected     called when the first connection is made
    Ending run(bool must_connect, const std::function<void()>& connected);

  private:
    void handle_events();
    void carry_out(Action action);
    void close_front();
    void toggle_replay();
    void save_screenshot();

    Screen& screen_;
    sf::Window& window_;
    WindowRenderer& renderer_;
    Panes panes_;
    Input input_;
    core::WorldView::Clock::time_point now_{};
    core::WorldView::Clock::time_point asked_to_quit_{}; // the next Esc quits, for a while
    bool to_start_screen_ = false;
};

} // namespace evod::viewer
