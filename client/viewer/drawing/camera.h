// Camera: maps a part of an island to a part of the window.
//
// There are two coordinate systems, both with +x to the right and +y down. World coordinates are in px, the model's
// unit of length. Screen coordinates are in pixels of the window. The viewport is the part of the window in which the
// island is drawn; the strips with texts are outside the viewport.
//
// Owner        WorldView.
// Threads      none; used on the drawing thread.
#pragma once

namespace evod::viewer {

struct Point {
    double x = 0, y = 0;
    friend bool operator==(const Point&, const Point&) = default;
};

struct Rectangle {
    double left = 0, top = 0, width = 0, height = 0;
    Point centre() const { return {left + width / 2, top + height / 2}; }
    bool contains(Point point) const {
        return point.x >= left && point.x <= left + width && point.y >= top && point.y <= top + height;
    }
    friend bool operator==(const Rectangle&, const Rectangle&) = default;
};

class Camera {
  public:
    static constexpr double zoom_max = 64;     // pixels on the screen per px of the world
    static constexpr double wall_pixels = 6;   // thickness of the walls in pixels at scale 1, at any zoom
    static constexpr double margin_pixels = 6; // space around the walls when the whole island is shown, at scale 1

    /// Sets the viewport, and the factor for sizes given in pixels at scale 1. If the whole island was fitted into the
    /// old viewport, it is fitted into the new one; otherwise the centre and the zoom do not change.
    void set_viewport(Rectangle screen, double scale = 1);

    /// Sets the size of the island, in px of the world. If the size has changed, fits the whole island into the
    /// viewport.
    void set_island(double width, double height);

    /// Centres the island and chooses the largest zoom at which the whole island and its walls are visible.
    void fit();
    bool fitted() const { return fitted_; }

    /// Moves the drawn island by this many pixels. The viewport stays on the island.
    void pan(Point pixels);

    /// Centres the viewport on a point of the world, as far as the viewport stays on the island.
    void look_at(Point world);

    /// Multiplies the zoom by `factor`, clamped to zoom_min() to zoom_max. The world point under `screen` does not
    /// move, as far as the viewport stays on the island.
    void zoom_at(Point screen, double factor);

    Point to_screen(Point world) const;
    Point to_world(Point screen) const;

    const Rectangle& viewport() const { return viewport_; }
    double scale() const { return scale_; }
    Point centre() const { return centre_; } // the point of the world in the middle of the viewport
    double zoom() const { return zoom_; }    // pixels on the screen per px of the world
    double zoom_min() const;                 // half of the zoom that fit() sets
    Rectangle visible() const;               // the visible part of the world

  private:
    double zoom_to_fit() const;
    void stay_on_island();

    Rectangle viewport_{0, 0, 1, 1};
    double scale_ = 1;
    double island_width_ = 1, island_height_ = 1;
    Point centre_{0.5, 0.5};
    double zoom_ = 1;
    bool fitted_ = true;
};

} // namespace evod::viewer
