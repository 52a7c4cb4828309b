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

#include <array>
#include <cstddef>
#include <span>

namespace evod::viewer {

/// A circle, rectangle, leaf or star: its centre and half size, in px of the world. The half width of a circle, leaf,
/// star or triangle is its radius. The half height of a body or triangle is not a length but its health, from 0 to 1.
struct Shape {
    float x = 0, y = 0, half_width = 0, half_height = 0;
};

/// A line, arrow or soft line from its begin to its end, in px of the world. The tip of an arrow is at the end.
struct Line {
    float x = 0, y = 0, end_x = 0, end_y = 0;
};

enum class Form {
    Circle,
    Rectangle,
    Line,
    Arrow,
    Body,   // a disc with an arc around it that shows the health, clockwise from the top
    Leaf,   // around the disc of its radius, pointed at the upper right and the lower left, with a vein if it is large
    Star,   // four spikes twice as long as its radius, like the letter X
    Ripple, // a disc that is transparent at its centre
    SoftLine, // fades out at both sides
    Triangle  // upright, of about the area of the disc of its radius; its fill shows the health
};
constexpr std::size_t form_count = 10;

/// All sizes in pixels are those at scale 1; they are multiplied by the scale of the camera.
struct ShapeStyle {
    Form form = Form::Circle;
    Colour fill{}, edge{};     // `fill` is used by layers that have no colours per shape
    Colour fill_low{};         // of a body or triangle without health; its colour changes to `fill` with its health
    float edge_pixels = 0;     // width of the edge, drawn inside the outline; 0: none. Of a body: of the arc, at most
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
    float half_width_max_ = 0; // of shapes; unused for lines
    bool coloured_ = false;
};

class ShapePainter {
  public:
    ShapePainter();
    ~ShapePainter();
    ShapePainter(const ShapePainter&) = delete;
    ShapePainter& operator=(const ShapePainter&) = delete;

    /// Restricts drawing to the camera's viewport until end().
    void begin(const Camera& camera, unsigned width_pixels, unsigned height_pixels);
    /// Restricts drawing to a rectangle of the screen, within the viewport.
    void clip(const Rectangle& screen);
    void clip_to_viewport() { clip(camera_.viewport()); }
    /// Fills a rectangle of the screen, clipped at the viewport, in whole pixels. Ends a clip().
    void fill(const Rectangle& screen, Colour colour);
    void draw(const Layer& layer, const ShapeStyle& style);
    void end();

  private:
    /// The shader for one form, compiled when it is used first. A shader without branches is faster. Small round shapes
    /// of a whole island are drawn as points: one vertex each instead of three, and half as many pixels.
    struct Program {
        unsigned name = 0;
        int pixel_size = 0, origin = 0, centre = 0, zoom = 0, coloured = 0, fill = 0, fill_low = 0, edge = 0,
            edge_pixels = 0, half_pixels_min = 0, line_pixels = 0;
    };
    const Program& program_of(Form form, bool point);

    std::array<Program, 2 * form_count> programs_{}; // of each form: as triangles, as points
    float point_pixels_max_ = 10;                    // larger shapes are triangles
    unsigned vertex_array_ = 0;                      // there are no vertex attributes: the shader reads shapes by index
    Camera camera_;
    unsigned width_pixels_ = 1, height_pixels_ = 1;
};

} // namespace evod::viewer
