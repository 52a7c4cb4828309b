// Timeline: the strip below a replay. The user drags along a line of all its ticks to seek. Buttons play the replay, go
// to the previous or next generation, and return to the live world.
//
// Owner        WorldView.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/gui.h"
#include "client/viewer/world/viewed_world.h"

#include <cstdint>
#include <map>
#include <set>
#include <string>

namespace evod::viewer {

class Timeline {
  public:
    static constexpr double height_pixels = 62; // height of the strip at scale 1

    /// Draws the time line of a replay; draws nothing for a live world. Call between Gui::begin() and Gui::draw().
    void build(ViewedWorld& world, const Gui& gui, Rectangle place);

  private:
    void build_line(ViewedWorld& world, const Gui& gui, Rectangle place);
    void build_buttons(ViewedWorld& world, float pixel);
    void find_first_ticks(ViewedWorld& world, const evod::v1::Replay& replay, std::size_t count_max);

    std::string world_, run_id_;                        // identify the replay that the members below describe
    std::map<std::uint64_t, std::uint64_t> first_tick_; // first tick by generation
    std::set<std::uint64_t> requested_;                 // generations whose first tick has been requested
    std::uint64_t shown_generation_ = 0;
    int typed_generation_ = 1;
};

} // namespace evod::viewer
