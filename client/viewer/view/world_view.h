// WorldView: the viewed world with its cameras, minimap and time line, and the part of the window in which it is drawn.
//
// Owner        Window, or the code that saves screenshots and recordings without a window.
// Threads      used by the thread that draws.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/island/island_view.h"
#include "client/viewer/island/minimap.h"
#include "client/viewer/island/streamed_region.h"
#include "client/viewer/view/timeline.h"
#include "client/viewer/world/island_data.h"
#include "client/viewer/world/viewed_world.h"

#include <cstdint>
#include <map>
#include <string>
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
    IslandData island_data; // of the chosen island
    IslandView island_view{world.feed, island_data};
    Minimap minimap;
    Timeline timeline;

    /// The camera of the chosen island.
    Camera& camera() { return camera_of(world.feed.island()); }
    /// The camera of the tile at a point of the window. If no tile is there, returns the camera of the chosen island.
    Camera& camera_at(Point screen);
    /// The tiles: one for the chosen island, or one for each island.
    std::vector<Tile> tiles();
    /// Reads the newest snapshot of the chosen island, requests the data that the view options need, and moves the
    /// streamed region.
    ///
    /// points_at  whether the mouse points at an organism
    void update_island(core::SnapshotInterpolator::Clock::time_point now, bool points_at = false);
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
    void update_stream(core::SnapshotInterpolator::Clock::time_point now);
    Camera& camera_of(std::uint32_t island) { return world.feed.all_islands() ? cameras_[island] : camera_; }

    IslandView others_;
    Camera camera_; // used while only one island is shown
    std::map<std::uint32_t, Camera> cameras_;
    Rectangle place_, timeline_place_;
    StreamedRegion region_;
    std::uint64_t streamed_place_ = 0; // the place and the run of region_
    std::string streamed_run_;
    bool in_part_ = false; // whether the island is large and therefore streamed in part
};

} // namespace evod::viewer
