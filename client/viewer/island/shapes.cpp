#define GL_GLEXT_PROTOTYPES
#include "client/viewer/island/shapes.h"

#include <GL/gl.h>
#include <GL/glext.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace evod::viewer {

namespace {

// The shader subtracts the camera's centre from a position before it multiplies by the zoom. The difference of nearby
// positions is exact in floats, but each product would be rounded.
constexpr const char* vertex_source = R"(
uniform samplerBuffer shapes;        // centre and half size; for lines and arrows, begin and end
uniform samplerBuffer colours;
uniform bool coloured;               // whether each shape has its own colour
uniform vec2 pixel_size;             // size of one pixel in clip space
uniform vec2 origin;                 // centre of the viewport, in pixels
uniform vec2 centre;
uniform float zoom, half_pixels_min, line_pixels, edge_pixels;
uniform vec4 fill, fill_low;
#if POINT
flat out float reach;                // half the size of the point, in pixels
#else
out vec2 place;                      // offset from the shape's centre, in pixels, along the shape's axes
#endif
flat out vec2 half_size;
flat out vec4 own_fill;
flat out vec3 arc;                   // of a body: direction across the end of the arc; health
flat out float rim;                  // of a body: width of the arc; 0: none
void main() {
    int index = POINT == 1 ? gl_VertexID : gl_VertexID / 3;
    vec4 shape = texelFetch(shapes, index);
    own_fill = coloured ? texelFetch(colours, index) : fill;
    vec2 middle = (shape.xy - centre) * zoom, along = vec2(1.0, 0.0), around = vec2(0.5);
    half_size = max(shape.zw * zoom, vec2(half_pixels_min));
    arc = vec3(0.0);
    rim = 0.0;
#if FORM == LINE || FORM == ARROW || FORM == SOFT_LINE
    vec2 way = (shape.zw - shape.xy) * zoom;
    float pixels = length(way);
    middle += way / 2.0;
    along = pixels > 0.0 ? way / pixels : along;
    half_size = vec2(pixels, line_pixels) / 2.0;
    around += FORM == ARROW ? vec2(line_pixels, 2.5 * line_pixels) : vec2(line_pixels);
#elif FORM == BODY
    half_size = half_size.xx;
    rim = half_size.x < 0.8 * edge_pixels ? 0.0 : min(edge_pixels, 0.4 * half_size.x); // a small body has no arc
    around += 1.6 * rim;
    arc = vec3(cos(6.2831853 * shape.w), sin(6.2831853 * shape.w), shape.w);
    own_fill = coloured ? own_fill : mix(fill_low, fill, shape.w);
#elif FORM == LEAF || FORM == STAR
    around += 0.5 + 0.5 * half_size;
#endif
#if POINT
    bool dot = half_size.x <= 0.5; // fills the pixel at its centre
    reach = dot ? 0.5 : half_size.x + around.x;
    gl_PointSize = 2.0 * reach;
    vec2 pixel = dot ? floor(origin + middle) + 0.5 : origin + middle;
#else
    int corner_index = gl_VertexID % 3; // one triangle covers the rectangle around the shape
    vec2 corner = vec2(corner_index == 1, corner_index == 2) * 4.0 - 1.0;
    place = corner * (half_size + around);
    vec2 pixel = origin + middle + along * place.x + vec2(-along.y, along.x) * place.y;
#endif
    gl_Position = vec4(pixel.x * pixel_size.x - 1.0, 1.0 - pixel.y * pixel_size.y, 0.0, 1.0);
}
)";

// The shader computes how much of a pixel a shape covers from the distance between the pixel's centre and the outline.
constexpr const char* fragment_source = R"(
#if POINT
flat in float reach;
#define place ((2.0 * gl_PointCoord - 1.0) * reach)
#else
in vec2 place;
#endif
flat in vec2 half_size;
flat in vec4 own_fill;
flat in vec3 arc;
flat in float rim;
uniform vec4 edge;
uniform float edge_pixels, line_pixels;
out vec4 colour;                     // with premultiplied alpha
float covered(float outside) {
    return clamp(0.5 - outside, 0.0, 1.0);
}
#if FORM == BODY
void main() {
    float radius = half_size.x, distance = length(place);
    float outer = radius + 1.6 * rim, share = distance / radius;
    float before_end = -dot(place, arc.xy), after_begin = place.x;
    float within = arc.z < 0.5 ? min(after_begin, before_end) : max(after_begin, before_end);
    float lit = arc.z <= 0.0 ? 0.0 : arc.z >= 1.0 ? 1.0 : clamp(within + 0.5, 0.0, 1.0);
    float ring = covered(distance - outer) - covered(distance - outer + rim);
    colour = vec4(own_fill.rgb * (1.0 - 0.2 * share * share), 1.0) * own_fill.a * covered(distance - radius) +
             vec4(edge.rgb, 1.0) * edge.a * ring * (0.2 + 0.8 * lit);
}
#elif FORM == RIPPLE
void main() {
    float share = length(place) / half_size.x;
    colour = vec4(own_fill.rgb, 1.0) * own_fill.a * share * share * covered(length(place) - half_size.x);
}
#elif FORM == SOFT_LINE
void main() {
    float across = clamp(1.0 - abs(place.y) / half_size.y, 0.0, 1.0);
    colour = vec4(own_fill.rgb, 1.0) * own_fill.a * across * covered(abs(place.x) - half_size.x);
}
#else
float distance_outside() {
    vec2 beyond = abs(place) - half_size;
#if FORM == CIRCLE
    return length(place) - half_size.x;
#elif FORM == RECTANGLE
    return max(beyond.x, beyond.y);
#elif FORM == LEAF                   // the overlap of two discs
    vec2 tilted = vec2(place.x - place.y, place.x + place.y) * 0.7071;
    return length(vec2(tilted.x, abs(tilted.y) + 1.018 * half_size.x)) - 2.068 * half_size.x;
#elif FORM == STAR                   // the distance from the line between a tip and the valley beside it
    vec2 tilted = abs(vec2(place.x - place.y, place.x + place.y)) * 0.7071;
    tilted = tilted.y > tilted.x ? tilted.yx : tilted;
    return dot(tilted - vec2(2.0 * half_size.x, 0.0), vec2(0.339, 0.941));
#else
    float outside = length(vec2(max(beyond.x, 0.0), place.y)) - half_size.y;
#if FORM == ARROW
    float head = min(4.5 * line_pixels, half_size.x), behind_tip = half_size.x - place.x;
    outside = min(outside, max((abs(place.y) - behind_tip / 2.0) * 0.894, behind_tip - head));
#endif
    return outside;
#endif
}
void main() {
    float outside = distance_outside();
    float whole = covered(outside), inner = covered(outside + edge_pixels);
    vec3 inside = own_fill.rgb;
#if FORM == LEAF
    float vein = 0.09 * half_size.x;
    inside *= 1.0 - 0.35 * covered(abs(place.x + place.y) * 0.7071 - vein) * clamp(vein - 0.3, 0.0, 1.0);
#endif
    colour = vec4(edge.rgb, 1.0) * edge.a * (whole - inner) + vec4(inside, 1.0) * own_fill.a * inner;
}
#endif
)";

std::string with_form(const char* source, Form form, bool point) {
    constexpr std::array<const char*, form_count> names{"CIRCLE", "RECTANGLE", "LINE",   "ARROW",    "BODY",
                                                        "LEAF",   "STAR",      "RIPPLE", "SOFT_LINE"};
    std::string text = "#version 330 core\n";
    for (std::size_t i = 0; i < names.size(); ++i) {
        text += "#define " + std::string{names[i]} + " " + std::to_string(i) + "\n";
    }
    return text + "#define POINT " + (point ? "1" : "0") + "\n#define FORM " + names[static_cast<std::size_t>(form)] +
           "\n" + source;
}

unsigned compile(GLenum kind, const std::string& source) {
    const unsigned shader = glCreateShader(kind);
    const char* text = source.c_str();
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    int compiled = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (!compiled) {
        std::array<char, 1024> log{};
        glGetShaderInfoLog(shader, log.size(), nullptr, log.data());
        throw std::runtime_error{std::string{"evoview needs OpenGL 3.3: "} + log.data()};
    }
    return shader;
}

void set_colour(int location, Colour colour) {
    glUniform4f(location, colour.red / 255.f, colour.green / 255.f, colour.blue / 255.f, colour.alpha / 255.f);
}

} // namespace

Layer::Column::Column(unsigned format) {
    glGenBuffers(1, &buffer);
    glBindBuffer(GL_TEXTURE_BUFFER, buffer);
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_BUFFER, texture);
    glTexBuffer(GL_TEXTURE_BUFFER, format, buffer);
    glBindTexture(GL_TEXTURE_BUFFER, 0);
}

Layer::Column::~Column() {
    glDeleteTextures(1, &texture);
    glDeleteBuffers(1, &buffer);
}

void Layer::Column::set(std::span<const std::byte> bytes) {
    glBindBuffer(GL_TEXTURE_BUFFER, buffer);
    glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(bytes.size()), bytes.data(), GL_STREAM_DRAW);
}

Layer::Layer() : shapes_{GL_RGBA32F}, colours_{GL_RGBA8} {}

void Layer::set(std::span<const Shape> shapes, std::span<const Colour> colours) {
    half_width_max_ = 0;
    for (const Shape& shape : shapes) {
        half_width_max_ = std::max(half_width_max_, shape.half_width);
    }
    upload(std::as_bytes(shapes), colours);
}

void Layer::set(std::span<const Line> lines, std::span<const Colour> colours) {
    upload(std::as_bytes(lines), colours);
}

void Layer::upload(std::span<const std::byte> shapes, std::span<const Colour> colours) {
    static_assert(sizeof(Shape) == 16 && sizeof(Line) == 16 && sizeof(Colour) == 4);
    count_ = shapes.size() / sizeof(Shape);
    coloured_ = !colours.empty();
    shapes_.set(shapes);
    if (coloured_) {
        colours_.set(std::as_bytes(colours));
    }
}

ShapePainter::ShapePainter() {
    std::array<float, 2> sizes{}; // the smallest and the largest point that the driver draws
    glGetFloatv(GL_ALIASED_POINT_SIZE_RANGE, sizes.data());
    point_pixels_max_ = std::min(sizes[1], point_pixels_max_);
    glGenVertexArrays(1, &vertex_array_);
}

ShapePainter::~ShapePainter() {
    glDeleteVertexArrays(1, &vertex_array_);
    for (const Program& program : programs_) {
        glDeleteProgram(program.name);
    }
}

const ShapePainter::Program& ShapePainter::program_of(Form form, bool point) {
    Program& program = programs_[2 * static_cast<std::size_t>(form) + (point ? 1 : 0)];
    if (program.name != 0) {
        return program;
    }
    const unsigned vertex = compile(GL_VERTEX_SHADER, with_form(vertex_source, form, point));
    const unsigned fragment = compile(GL_FRAGMENT_SHADER, with_form(fragment_source, form, point));
    program.name = glCreateProgram();
    glAttachShader(program.name, vertex);
    glAttachShader(program.name, fragment);
    glLinkProgram(program.name);
    glDeleteShader(vertex);
    glDeleteShader(fragment);
    const auto uniform = [&](const char* name) { return glGetUniformLocation(program.name, name); };
    program.pixel_size = uniform("pixel_size");
    program.origin = uniform("origin");
    program.centre = uniform("centre");
    program.zoom = uniform("zoom");
    program.coloured = uniform("coloured");
    program.fill = uniform("fill");
    program.fill_low = uniform("fill_low");
    program.edge = uniform("edge");
    program.edge_pixels = uniform("edge_pixels");
    program.half_pixels_min = uniform("half_pixels_min");
    program.line_pixels = uniform("line_pixels");
    glUseProgram(program.name);
    glUniform1i(uniform("shapes"), 0);
    glUniform1i(uniform("colours"), 1);
    return program;
}

void ShapePainter::begin(const Camera& camera, unsigned width_pixels, unsigned height_pixels) {
    camera_ = camera;
    width_pixels_ = width_pixels;
    height_pixels_ = height_pixels;
    glViewport(0, 0, static_cast<int>(width_pixels), static_cast<int>(height_pixels));
    glEnable(GL_SCISSOR_TEST);
    clip_to_viewport();
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glEnable(GL_PROGRAM_POINT_SIZE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glBindVertexArray(vertex_array_);
}

void ShapePainter::clip(const Rectangle& screen) {
    const Rectangle& viewport = camera_.viewport();
    const auto pixel = [](double value, double from, double size) {
        return static_cast<int>(std::lround(std::clamp(value, from, from + size)));
    };
    const int left = pixel(screen.left, viewport.left, viewport.width);
    const int right = pixel(screen.left + screen.width, viewport.left, viewport.width);
    const int top = pixel(screen.top, viewport.top, viewport.height);
    const int bottom = pixel(screen.top + screen.height, viewport.top, viewport.height);
    glScissor(left, static_cast<int>(height_pixels_) - bottom, right - left, bottom - top);
}

void ShapePainter::fill(const Rectangle& screen, Colour colour) {
    clip(screen);
    glClearColor(colour.red / 255.f, colour.green / 255.f, colour.blue / 255.f, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    clip_to_viewport();
}

void ShapePainter::draw(const Layer& layer, const ShapeStyle& style) {
    if (layer.count_ == 0) {
        return;
    }
    const auto scale = static_cast<float>(camera_.scale()), zoom = static_cast<float>(camera_.zoom());
    const bool round = style.form == Form::Circle || style.form == Form::Body;
    const float half_pixels = std::max(layer.half_width_max_ * zoom, scale * style.half_pixels_min);
    // Drivers in software reject points out of sight much more slowly than triangles: draw points only if the island is
    // almost whole in sight. When it is fitted into the viewport, the zoom is twice zoom_min().
    const bool in_sight = camera_.zoom() <= 2.5 * camera_.zoom_min();
    const bool point =
        round && in_sight && 2 * (half_pixels + 1.6f * scale * style.edge_pixels + 0.5f) <= point_pixels_max_;
    const Program& program = program_of(style.form, point);
    const Point middle = camera_.viewport().centre(), centre = camera_.centre();
    glUseProgram(program.name);
    glUniform2f(program.pixel_size, 2.f / static_cast<float>(width_pixels_), 2.f / static_cast<float>(height_pixels_));
    glUniform2f(program.origin, static_cast<float>(middle.x), static_cast<float>(middle.y));
    glUniform2f(program.centre, static_cast<float>(centre.x), static_cast<float>(centre.y));
    glUniform1f(program.zoom, zoom);
    glUniform1i(program.coloured, layer.coloured_);
    set_colour(program.fill, style.fill);
    set_colour(program.fill_low, style.fill_low);
    set_colour(program.edge, style.edge);
    glUniform1f(program.edge_pixels, scale * style.edge_pixels);
    glUniform1f(program.half_pixels_min, scale * style.half_pixels_min);
    glUniform1f(program.line_pixels, scale * style.line_pixels);
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_BUFFER, layer.colours_.texture);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_BUFFER, layer.shapes_.texture);
    if (point) {
        glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(layer.count_));
    } else {
        glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(3 * layer.count_));
    }
}

void ShapePainter::end() {
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_BUFFER, 0);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_BUFFER, 0);
    glBindVertexArray(0);
    glUseProgram(0);
    glDisable(GL_PROGRAM_POINT_SIZE);
    glDisable(GL_SCISSOR_TEST);
}

} // namespace evod::viewer
