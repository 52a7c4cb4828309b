// Pane: a part of the window with its own world, cameras and time line.
// Panes: the one or two panes of a window, side by side. Keys act on the pane that has the focus.
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

/// Part of a pane: shows one island.
struct Tile {
    std::uint32_t island;
    core::SnapshotInterpolator& view;
    Camera& camera;
};

class Pane {
  public:
    Pane(WantedWorld wanted, const ViewOptions& view) : world{std::move(wanted)} { island_view.options = view; }

    ViewedWorld world;
    IslandView island_view; // how the chosen island is shown
    Minimap minimap;
    Timeline timeline;

    /// The camera of the chosen island.
    Camera& camera() { return camera_of(world.feed.island()); }
    /// The tiles of the pane: one for the chosen island, or one for each island.
    std::vector<Tile> tiles();
    /// The view options of a tile. Islands that are not chosen are shown with the same options, but only with the data
    /// in their snapshots.
    const IslandView& island_view_of(const Tile& tile);

    /// Sets the part of the window in which the pane is drawn.
    ///
    /// with_timeline  if the world is a replay, reserve the bottom of the pane for its time line
    void lay_out(Rectangle place, bool with_timeline, double scale);
    const Rectangle& place() const { return place_; }                   // without the time line
    const Rectangle& timeline_place() const { return timeline_place_; } // height 0: no time line

  private:
    Camera& camera_of(std::uint32_t island) { return world.feed.all_islands() ? cameras_[island] : camera_; }

    IslandView others_;
    Camera camera_; // used while only one island is shown
    std::map<std::uint32_t, Camera> cameras_;
    Rectangle place_, timeline_place_;
};

class Panes {
  public:
    /// beside  world of a second pane; nullopt: no second pane
    /// view    how each pane shows its island at first
    explicit Panes(WantedWorld wanted, const std::optional<std::string>& beside = {}, const ViewOptions& view = {});

    /// Processes everything that each pane has received from its server since the last call.
    void update(core::SnapshotInterpolator::Clock::time_point now);
    /// Places the panes in the window.
    ///
    /// place           the part of the window beside the sidebar
    /// with_timelines  reserve space for the time lines of replays
    void lay_out(Rectangle place, bool with_timelines, double scale);

    std::size_t size() const { return panes_.size(); }
    Pane& operator[](std::size_t index) { return *panes_[index]; }
    Pane& focused() { return *panes_[focus_]; }
    bool has_focus(const Pane& pane) const { return panes_.size() > 1 && panes_[focus_].get() == &pane; }

    /// Moves the focus to the pane at a point of the window and chooses the island at this point. Returns false if no
    /// pane is there.
    bool focus_at(Point screen);
    void focus(std::size_t index) { focus_ = index; }
    void focus_next() { focus_ = (focus_ + 1) % panes_.size(); }
    /// The camera of the tile at a point of the window. If no tile is there, returns the camera of the focused pane.
    Camera& camera_at(Point screen);

    /// With one pane, opens a second one and moves the focus to it. It shows the newest fork of the focused world.
    /// Without a fork, it shows the live world of the focused replay. Otherwise it shows the next world of the server,
    /// as soon as its name has arrived; if there is no other world, the window offers to create one. With two panes,
    /// closes the pane without the focus.
    void toggle_beside();
    void toggle_linked() { linked_ = !linked_; }
    bool linked() const { return linked_; }
    /// If cameras are linked, makes all of them show the same part of their islands as `leader`.
    void link_cameras(const Camera& leader);

  private:
    void show_beside(std::size_t pane, std::string world);
    void open_beside(std::string world, std::uint32_t island);

    std::vector<std::unique_ptr<Pane>> panes_; // never empty
    std::uint64_t next_request_number_ = 0;    // number of the last request for the next world
    std::string next_world_;                   // a world to open in the next update(); empty: none
    std::size_t focus_ = 0;
    bool linked_ = false;
    WantedWorld wanted_; // settings for the next pane
};

} // namespace evod::viewer
