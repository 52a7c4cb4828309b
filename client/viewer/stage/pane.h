// Pane: a part of the window with a world of its own: its watch, the cameras of its islands, its time line.
// Panes: those of a window, one or two side by side. The keys act on the one with the focus.
//
// Owner        the window, or the taking of pictures without one.
// Threads      used by the thread that draws.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/scene/minimap.h"
#include "client/viewer/scene/sight.h"
#include "client/viewer/stage/timeline.h"
#include "client/viewer/watch/watch.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

/// An island as it is drawn: what is known of it, and where and how it is seen.
struct Tile {
    std::uint32_t island;
    core::WorldView& view;
    Camera& camera;
};

class Pane {
  public:
    explicit Pane(Watch::Wanted wanted) : watch{std::move(wanted)} {}

    Watch watch;
    Sight sight; // of the island that is chosen
    Minimap minimap;
    Timeline timeline;
    double blend = 1; // of the picture of that island that was drawn last

    /// Of the island that is chosen.
    Camera& camera() { return camera_of(watch.island()); }
    /// All that is seen of the world here: one island, or all of them as tiles.
    std::vector<Tile> tiles();
    /// What is shown there: of islands that are not chosen only what their pictures tell, with the same switches.
    const Sight& sight_of(const Tile& tile);

    /// Gives the pane its part of the window.
    ///
    /// with_timeline  a world that shows the past has its time line at the bottom
    void lay_out(Rectangle place, bool with_timeline, double scale);
    const Rectangle& place() const { return place_; }                   // without the time line
    const Rectangle& timeline_place() const { return timeline_place_; } // of no height if there is none

  private:
    Camera& camera_of(std::uint32_t island) { return watch.all_islands() ? cameras_[island] : camera_; }

    Sight others_;
    Camera camera_; // of islands one at a time
    std::map<std::uint32_t, Camera> cameras_;
    Rectangle place_, timeline_place_;
};

class Panes {
  public:
    /// beside  a second world; nullopt: only one
    explicit Panes(Watch::Wanted wanted, const std::optional<std::string>& beside = {});

    /// Takes in what has come for each of them.
    void update(core::WorldView::Clock::time_point now);
    /// interactive  with what hands act upon: the strip of the panels, time lines
    void lay_out(unsigned width_pixels, unsigned height_pixels, bool interactive, double scale);

    std::size_t size() const { return panes_.size(); }
    Pane& operator[](std::size_t index) { return *panes_[index]; }
    Pane& focused() { return *panes_[focus_]; }
    bool has_focus(const Pane& pane) const { return panes_.size() > 1 && panes_[focus_].get() == &pane; }

    /// Gives the focus to the pane at a point of the window, and chooses the island there. False: there is none.
    bool focus_at(Point screen);
    void focus(std::size_t index) { focus_ = index; }
    void focus_next() { focus_ = (focus_ + 1) % panes_.size(); }
    /// Of the tile at a point of the window; of the focused pane where there is none.
    Camera& camera_at(Point screen);

    /// A second world beside the one with the focus, which it takes over: the fork that was made there, its present, or
    /// the next world, as soon as the server has told which that is. Where there are two already, the one without the
    /// focus goes.
    void toggle_beside();
    void toggle_linked() { linked_ = !linked_; }
    bool linked() const { return linked_; }
    /// If they are linked, all cameras show the part of their islands that `leader` shows.
    void link_cameras(const Camera& leader);

  private:
    void open_beside(std::string world, std::uint32_t island);

    std::vector<std::unique_ptr<Pane>> panes_; // never empty
    std::uint64_t next_asked_count_ = 0;       // times that the server was asked which world comes next
    std::string next_;                         // its newest answer, to be opened; empty: none
    std::size_t focus_ = 0;
    bool linked_ = false;
    Watch::Wanted wanted_; // of the first
};

} // namespace evod::viewer
