// Pane: a part of the window with its own world, cameras and time line.
// Panes: the panes of a window, one or two side by side. The keys act on the pane with the focus.
//
// Owner        Window, or the code that saves screenshots and recordings without a window.
// Threads      used by the thread that draws.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/island/island_view.h"
#include "client/viewer/island/minimap.h"
#include "client/viewer/panes/timeline.h"
#include "client/viewer/world/viewed_world.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

/// The part of a pane that shows one island.
struct Tile {
    std::uint32_t island;
    core::WorldView& view;
    Camera& camera;
};

class Pane {
  public:
    explicit Pane(WantedWorld wanted) : world{std::move(wanted)} {}

    ViewedWorld world;
    IslandView island_view; // of the chosen island
    Minimap minimap;
    Timeline timeline;
    double blend = 1; // of the chosen island in the last frame: 0 to 1 between two snapshots

    /// Of the chosen island.
    Camera& camera() { return camera_of(world.feed.island()); }
    /// One tile for the chosen island, or one for each island.
    std::vector<Tile> tiles();
    /// The view of a tile. Islands that are not chosen have the same options, but no data beyond their snapshots.
    const IslandView& island_view_of(const Tile& tile);

    /// Gives the pane its part of the window.
    ///
    /// with_timeline  reserve the bottom for a time line if the world is a replay
    void lay_out(Rectangle place, bool with_timeline, double scale);
    const Rectangle& place() const { return place_; }                   // without the time line
    const Rectangle& timeline_place() const { return timeline_place_; } // height 0 if there is none

  private:
    Camera& camera_of(std::uint32_t island) { return world.feed.all_islands() ? cameras_[island] : camera_; }

    IslandView others_;
    Camera camera_; // while one island is shown
    std::map<std::uint32_t, Camera> cameras_;
    Rectangle place_, timeline_place_;
};

class Panes {
  public:
    /// beside  a second world; nullopt: one pane only
    explicit Panes(WantedWorld wanted, const std::optional<std::string>& beside = {});

    /// Takes in what has arrived for each pane.
    void update(core::WorldView::Clock::time_point now);
    /// interactive  with room for the strip of panels and for time lines
    void lay_out(unsigned width_pixels, unsigned height_pixels, bool interactive, double scale);

    std::size_t size() const { return panes_.size(); }
    Pane& operator[](std::size_t index) { return *panes_[index]; }
    Pane& focused() { return *panes_[focus_]; }
    bool has_focus(const Pane& pane) const { return panes_.size() > 1 && panes_[focus_].get() == &pane; }

    /// Gives the focus to the pane at a point of the window, and chooses the island there. False if there is no pane.
    bool focus_at(Point screen);
    void focus(std::size_t index) { focus_ = index; }
    void focus_next() { focus_ = (focus_ + 1) % panes_.size(); }
    /// The camera of the tile at a point of the window; without a tile there, that of the focused pane.
    Camera& camera_at(Point screen);

    /// Opens a second pane and gives it the focus. It shows the newest fork of the focused world, else its live world,
    /// else the next world of the server as soon as its name has arrived. If there are two panes, closes the one without
    /// the focus.
    void toggle_beside();
    void toggle_linked() { linked_ = !linked_; }
    bool linked() const { return linked_; }
    /// While linked, makes all cameras show the same part of their islands as `leader`.
    void link_cameras(const Camera& leader);

  private:
    void open_beside(std::string world, std::uint32_t island);

    std::vector<std::unique_ptr<Pane>> panes_; // never empty
    std::uint64_t next_request_number_ = 0;    // of requests for the next world
    std::string next_world_;                   // a world to open with the next update; empty: none
    std::size_t focus_ = 0;
    bool linked_ = false;
    WantedWorld wanted_; // of the next pane
};

} // namespace evod::viewer
