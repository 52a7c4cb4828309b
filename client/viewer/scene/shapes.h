// Shapes: many circles, rectangles, lines or arrows in one draw call.
//
// A layer holds shapes of one look on the graphics card, four numbers each, and if they differ in it, their colours.
// Their outlines are computed for each pixel from the distance to the edge, so they are smooth at any zoom, and moving
// the camera uploads nothing.
//
// Needs        OpenGL 3.3, current on the calling thread for as long as any of this lives.
// Threads      none.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/palette.h"

#include <cstddef>
#include <span>

namespace evod::viewer {

/// Centre and half size, in px of the world; a circle's half width is its radius.
struct Shape {
    float x = 0, y = 0, half_width = 0, half_height = 0;
};

/// From where to where, in px of the world; an arrow's tip is at its end.
struct Line {
    float x = 0, y = 0, end_x = 0, end_y = 0;
};

enum class Form { Circle, Rectangle, Line, Arrow };

struct Look {
    Form form = Form::Circle;
    Colour fill{}, edge{};     // fill: of layers that have no colours of their own
    float edge_pixels = 0;     // inside the outline; 0: none. Lines and arrows have none
    float half_pixels_min = 0; // smaller ones are drawn as large as this, to be seen at all
    float line_pixels = 1.5f;  // thickness of lines and arrows
};

class Layer {
  public:
    Layer();

    /// colours  as many as shapes, or none
    void set(std::span<const Shape> shapes, std::span<const Colour> colours = {});
    void set(std::span<const Line> lines, std::span<const Colour> colours = {});

  private:
    friend class ShapePainter;
    void upload(std::span<const std::byte> shapes, std::span<const Colour> colours);

    /// Numbers on the graphics card, to be fetched by index.
    struct Column {
        explicit Column(unsigned format);
        ~Column();
        Column(const Column&) = delete;
        Column& operator=(const Column&) = delete;
        void set(std::span<const std::byte> bytes);
        unsigned buffer = 0, texture = 0;
    };
    Column shapes_, colours_;
    std::size_t count_ = 0;
    bool coloured_ = false;
};

class ShapePainter {
  public:
    ShapePainter();
    ~ShapePainter();
    ShapePainter(const ShapePainter&) = delete;
    ShapePainter& operator=(const ShapePainter&) = delete;

    /// Clears the camera's viewport, and draws into it until end().
    void begin(const Camera& camera, unsigned width_pixels, unsigned height_pixels, Colour background);
    void draw(const Layer& layer, const Look& look);
    void end();

  private:
    unsigned program_ = 0, vertex_array_ = 0; // without attributes: shapes are fetched by number
    int pixel_size_ = 0, origin_ = 0, centre_ = 0, zoom_ = 0, form_ = 0, coloured_ = 0, fill_ = 0, edge_ = 0,
        edge_pixels_ = 0, half_pixels_min_ = 0, line_pixels_ = 0;
};

} // namespace evod::viewer
