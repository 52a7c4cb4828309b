// Timeline: the strip below a world that shows the past: all ticks of its run as a line to be dragged along, and
// buttons to play it, to go from generation to generation, to fork from the moment that is shown, to go back to the
// present.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/gui.h"
#include "client/viewer/watch/watch.h"

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace evod::viewer {

class Timeline {
  public:
    static constexpr double height_pixels = 62; // at scale 1

    /// Between Gui::begin() and Gui::draw(). Nothing of a world that lives.
    ///
    /// number  tells the time lines of a window apart
    void build(Watch& watch, const Gui& gui, Rectangle place, int number);
    /// Whether a button of the mouse went down on it, once.
    bool take_press() { return std::exchange(pressed_, false); }

  private:
    void build_line(Watch& watch, const Gui& gui, Rectangle place);
    void build_buttons(Watch& watch, float pixel);
    void build_fork(Watch& watch);
    void learn_beginnings(Watch& watch, const evod::v1::Replay& recording, std::size_t count_max);

    std::string world_, run_id_;                        // what the rest is about
    std::map<std::uint64_t, std::uint64_t> begin_tick_; // of generations
    std::set<std::uint64_t> asked_;                     // generations whose beginning was asked for
    std::uint64_t shown_generation_ = 0;
    int typed_generation_ = 1;
    bool pressed_ = false;
    std::array<char, 65> fork_name_{};
};

} // namespace evod::viewer
