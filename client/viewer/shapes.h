// Shapes: many circles or rectangles in one draw call.
//
// A layer holds shapes of one look on the graphics card, four numbers each. Their outlines are computed for each pixel
// from the distance to the edge, so they are smooth at any zoom, and moving the camera uploads nothing.
//
// Needs        OpenGL 3.3, current on the calling thread for as long as any of this lives.
// Threads      none.
#pragma once

#include "client/viewer/camera.h"
#include "client/viewer/palette.h"

#include <cstddef>
#include <span>

namespace evod::viewer {

/// Centre and half size, in px of the world; a circle's half width is its radius.
struct Shape {
    float x = 0, y = 0, half_width = 0, half_height = 0;
};

struct Look {
    bool round = true;
    Colour fill{}, edge{};
    float edge_pixels = 0;     // inside the outline; 0: none
    float half_pixels_min = 0; // smaller ones are drawn as large as this, to be seen at all
};

class Layer {
  public:
    Layer();
    ~Layer();
    Layer(const Layer&) = delete;
    Layer& operator=(const Layer&) = delete;

    void set(std::span<const Shape> shapes);

  private:
    friend class ShapePainter;
    unsigned buffer_ = 0, texture_ = 0;
    std::size_t count_ = 0;
};

class ShapePainter {
  public:
    ShapePainter();
    ~ShapePainter();
    ShapePainter(const ShapePainter&) = delete;
    ShapePainter& operator=(const ShapePainter&) = delete;

    /// Clears the whole picture, and draws into the camera's viewport until end().
    void begin(const Camera& camera, unsigned width_pixels, unsigned height_pixels, Colour background);
    void draw(const Layer& layer, const Look& look);
    void end();

  private:
    unsigned program_ = 0, vertex_array_ = 0; // without attributes: shapes are fetched by number
    int pixel_size_ = 0, origin_ = 0, centre_ = 0, zoom_ = 0, round_ = 0, fill_ = 0, edge_ = 0, edge_pixels_ = 0,
        half_pixels_min_ = 0;
};

} // namespace evod::viewer
