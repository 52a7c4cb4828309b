// Overlay: what is written over and around the island: strips of text, help, notices, and how the connection stands.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/camera.h"
#include "client/viewer/gui.h"
#include "client/viewer/watch.h"

#include <chrono>
#include <deque>
#include <optional>
#include <string>

namespace evod::viewer {

/// The part of a window that the strips leave to the island.
Rectangle viewport_of(unsigned width_pixels, unsigned height_pixels);

class Overlay {
  public:
    using Clock = link::WorldView::Clock;

    /// Shows a sentence for some seconds.
    void notice(std::string text, Clock::time_point now);
    void toggle_help() { help_ = !help_; }
    bool help() const { return help_; }
    void close_help() { help_ = false; }

    /// Between Gui::begin() and Gui::draw().
    void build(const Watch& watch, const Gui& gui, Clock::time_point now);
    /// What is known of one organism, beside it.
    void build_organism(const wire::Picture& picture, std::size_t organism, Point screen, const Gui& gui);

  private:
    struct Notice {
        std::string text;
        Clock::time_point until;
    };

    void build_strips(const Watch& watch, const Gui& gui);
    void build_connection(const Watch& watch, const Gui& gui);
    void build_notices(const Gui& gui, Clock::time_point now);
    void build_help();

    bool help_ = false;
    std::deque<Notice> notices_;
};

} // namespace evod::viewer
