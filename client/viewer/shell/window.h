// Window: worlds, live, and the keys that command the one with the focus.
//
// Owner        run().
// Threads      used by the thread that made it, which draws; the connection of each Watch has its own.
#pragma once

#include "client/viewer/shell/options.h"
#include "client/viewer/shell/screen.h"
#include "client/viewer/stage/input.h"
#include "client/viewer/stage/pane.h"

#include <functional>
#include <string>

namespace evod::viewer {

class Window {
  public:
    struct Ending {
        bool elsewhere = false; // to the start screen; else evoview is closed
        std::string reason;     // why there is no connection; empty: a person wants to go there
    };

    Window(Screen& screen, const Options& options);

    /// Until it is closed, or left for the start screen.
    ///
    /// must_connect  end, with the reason, if the first attempt to connect fails; else attempts go on
    /// connected     called when there is a connection for the first time
    Ending run(bool must_connect, const std::function<void()>& connected);

  private:
    void handle_events();
    void carry_out(Action action);
    void close_front();
    void look_at_past_or_present();
    void save_screenshot();

    Screen& screen_;
    sf::Window& window_;
    Stage& stage_;
    Panes panes_;
    Input input_;
    core::WorldView::Clock::time_point now_{};
    core::WorldView::Clock::time_point asked_to_quit_{}; // for a while the next Esc does
    bool elsewhere_ = false;                             // a person wants to go to the start screen
};

} // namespace evod::viewer
