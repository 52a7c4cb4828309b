// Minimap: shows the whole island in a corner of the viewport, with a rectangle around the visible part. It is drawn
// while part of the island is out of sight. Pressing the mouse on the minimap moves the camera there.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/gui.h"
#include "client/viewer/island/marks.h"
#include "client/viewer/world/viewed_world.h"

#include <memory>

namespace evod::viewer {

/// The position of the minimap on the screen, and its conversion between screen and world coordinates.
struct MinimapPlace {
    static constexpr double side_pixels_max = 180, margin_pixels = 12; // at scale 1

    Rectangle screen;
    double zoom = 1; // pixels on the screen per px of the world

    Point to_world(Point on_screen) const {
        return {(on_screen.x - screen.left) / zoom, (on_screen.y - screen.top) / zoom};
    }
    Point to_screen(Point world) const { return {screen.left + world.x * zoom, screen.top + world.y * zoom}; }
    /// Returns the rectangle on the screen that marks the visible part of the world, clipped at the walls.
    Rectangle visible_part(const Rectangle& visible) const;
};

/// Places the minimap in the lower right corner of the viewport.
///
/// scale  factor for sizes given in pixels at scale 1
MinimapPlace minimap_place(const Rectangle& viewport, double island_width, double island_height, double scale = 1);

/// Returns whether the whole island is visible.
bool is_whole_island_visible(const Camera& camera, double island_width, double island_height);

class Minimap {
  public:
    /// Draws the minimap. If the user presses a point of it, moves the camera there. Call between Gui::begin() and
    /// Gui::draw().
    void build(ViewedWorld& world, Camera& camera, const Gui& gui, Look look);

  private:
    std::shared_ptr<const codec::ReceivedSnapshot> counted_; // the snapshot whose organisms grid_ counts
    DensityGrid grid_;
};

} // namespace evod::viewer
