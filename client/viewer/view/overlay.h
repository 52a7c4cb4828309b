// Overlay: draws the texts over and around the islands: status strips, help, notices, and the state of the connection.
//
// Owner        WindowRenderer.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/gui.h"
#include "client/viewer/panels/panels.h"
#include "client/viewer/world/viewed_world.h"

#include <chrono>
#include <deque>
#include <optional>
#include <string>

namespace evod::viewer {

class Overlay {
  public:
    using Clock = core::SnapshotInterpolator::Clock;

    static constexpr std::chrono::seconds notice_shown{6};
    /// Shows a sentence for the duration `notice_shown`.
    void notice(std::string text, Clock::time_point now);
    void toggle_help() { help_ = !help_; }
    bool help() const { return help_; }

    // Call the following functions between Gui::begin() and Gui::draw().

    /// Draws notices and help.
    ///
    /// worlds  the part of the window in which the worlds are drawn
    void build(const Gui& gui, const Panels& panels, Rectangle worlds, Clock::time_point now);
    /// Draws the strips of a world in its part of the window, and the state of its connection.
    void build_world(const ViewedWorld& world, const Gui& gui, Rectangle place);
    /// Draws the number of the island in its tile.
    void build_tile(std::uint32_t island, const Gui& gui, Rectangle place, bool chosen);
    /// Draws a note beside the mouse.
    void build_hint(const std::string& text, Point screen, const Gui& gui);
    /// Draws the data of an organism beside the organism.
    void build_organism(const codec::ReceivedSnapshot& snapshot, std::size_t organism, Point screen, const Gui& gui);

  private:
    struct Notice {
        std::string text;
        Clock::time_point until;
    };

    void build_strips(const ViewedWorld& world, const Gui& gui, Rectangle place);
    void build_connection(const ViewedWorld& world, const Gui& gui, Rectangle place);
    void build_notices(const Gui& gui, Rectangle worlds, Clock::time_point now);
    void build_help(const Gui& gui, const Panels& panels);

    bool help_ = false;
    std::deque<Notice> notices_;
};

} // namespace evod::viewer
