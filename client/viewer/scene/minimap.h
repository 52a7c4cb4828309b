// Minimap: all of the island in a corner, while less than that is seen, with a frame around what is seen. A press on it
// takes the camera there.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/gui.h"
#include "client/viewer/scene/marks.h"
#include "client/viewer/watch/watch.h"

#include <memory>
#include <utility>

namespace evod::viewer {

/// Where the minimap stands on the screen, and what is where on it.
struct MinimapPlace {
    static constexpr double side_pixels_max = 180, margin_pixels = 12; // at scale 1

    Rectangle screen;
    double zoom = 1; // pixels per px of the world

    Point to_world(Point on_screen) const {
        return {(on_screen.x - screen.left) / zoom, (on_screen.y - screen.top) / zoom};
    }
    Point to_screen(Point world) const { return {screen.left + world.x * zoom, screen.top + world.y * zoom}; }
    /// What is seen, cut at the walls.
    Rectangle frame_of(const Rectangle& seen) const;
};

/// In the lower right corner of the viewport.
///
/// scale  of its pixels
MinimapPlace minimap_place(const Rectangle& viewport, double island_width, double island_height, double scale = 1);

/// Whether there is something of the island that is not seen.
bool sees_all(const Camera& camera, double island_width, double island_height);

class Minimap {
  public:
    /// Between Gui::begin() and Gui::draw(). Moves the camera to where it is pressed.
    ///
    /// number  tells the minimaps of a window apart
    void build(Watch& watch, Camera& camera, const Gui& gui, int number);
    /// Whether a button of the mouse went down on it, once.
    bool take_press() { return std::exchange(pressed_, false); }

  private:
    std::shared_ptr<const codec::DecodedSnapshot> counted_; // the picture of which grid_ is
    DensityGrid grid_;
    bool pressed_ = false;
};

} // namespace evod::viewer
