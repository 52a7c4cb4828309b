// WorldView: the viewed world with its cameras, minimap and time line, and the part of the window in which it is drawn.
//
// Owner        Window, or the code that saves screenshots and recordings without a window.
// Threads      used by the thread that draws.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/island/island_view.h"
#include "client/viewer/island/minimap.h"
#include "client/viewer/view/timeline.h"
#include "client/viewer/world/viewed_world.h"

#include <cstdint>
#include <map>
#include <vector>

namespace evod::viewer {

/// A part of the view that shows one island.
struct Tile {
    std::uint32_t island;
    core::SnapshotInterpolator& view;
    Camera& camera;
};

class WorldView {
  public:
    /// options  how islands are shown at first
    explicit WorldView(const WantedWorld& wanted, const ViewOptions& options = {}) : world{wanted} {
        island_view.options = options;
    }

    ViewedWorld world;
    IslandView island_view; // how the chosen island is shown
    Minimap minimap;
    Timeline timeline;

    /// The camera of the chosen island.
    Camera& camera() { return camera_of(world.feed.island()); }
    /// The camera of the tile at a point of the window. If no tile is there, returns the camera of the chosen island.
    Camera& camera_at(Point screen);
    /// The tiles: one for the chosen island, or one for each island.
    std::vector<Tile> tiles();
    /// Chooses the island at a point of the window, if there is one.
    void choose_island_at(Point screen);
    /// The view options of a tile. Islands that are not chosen are shown with the same options, but only with the data
    /// in their snapshots.
    const IslandView& island_view_of(const Tile& tile);

    /// Sets the part of the window in which the world is drawn.
    ///
    /// with_timeline  if the world is a replay, reserve the bottom for its time line
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

} // namespace evod::viewer
