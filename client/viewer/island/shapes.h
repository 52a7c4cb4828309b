// Shapes: draws many circles, rectangles, lines or arrows in one call.
//
// A Layer stores shapes of one style in graphics memory: four numbers for each shape, and a colour for each if the
// colours differ. The shader computes the outline per pixel from the distance to the edge, so it is smooth at any zoom.
// Moving the camera uploads nothing.
//
// Needs        a current OpenGL 3.3 context on the calling thread, from construction to destruction.
// Threads      used by the thread that draws.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/palette.h"

#include <cstddef>
#include <span>

namespace evod::viewer {

/// A circle or rectangle: its centre and half size, in px of the world. The half width of a circle is its radius.
struct Shape {
    float x = 0, y = 0, half_width = 0, half_height = 0;
};

/// A line or arrow from its begin to its end, in px of the world. The tip of an arrow is at the end.
struct Line {
    float x = 0, y = 0, end_x = 0, end_y = 0;
};

enum class Form { Circle, Rectangle, Line, Arrow };

struct ShapeStyle {
    Form form = Form::Circle;
    Colour fill{}, edge{};     // `fill` is used by layers that have no colours per shape
    float edge_pixels = 0;     // width of the edge, drawn inside the outline; 0: none; unused for lines and arrows
    float half_pixels_min = 0; // a smaller shape is drawn with this half size, so that it stays visible
    float line_pixels = 1.5f;  // thickness of lines and arrows
};

class Layer {
  public:
    Layer();

    /// Replaces the contents of the layer. `colours` contains one colour for each shape, or is empty.
    void set(std::span<const Shape> shapes, std::span<const Colour> colours = {});
    void set(std::span<const Line> lines, std::span<const Colour> colours = {});

  private:
    friend class ShapePainter;
    void upload(std::span<const std::byte> shapes, std::span<const Colour> colours);

    /// An array in graphics memory; the shader reads its elements by index.
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

    /// Fills the camera's viewport with `background` and restricts drawing to it until end().
    void begin(const Camera& camera, unsigned width_pixels, unsigned height_pixels, Colour background);
    void draw(const Layer& layer, const ShapeStyle& style);
    void end();

  private:
    unsigned program_ = 0, vertex_array_ = 0; // there are no vertex attributes: the shader reads shapes by index
    int pixel_size_ = 0, origin_ = 0, centre_ = 0, zoom_ = 0, form_ = 0, coloured_ = 0, fill_ = 0, edge_ = 0,
        edge_pixels_ = 0, half_pixels_min_ = 0, line_pixels_ = 0;
};

} // namespace evod::viewer
