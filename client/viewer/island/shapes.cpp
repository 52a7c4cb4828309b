#define GL_GLEXT_PROTOTYPES
#include "client/viewer/island/shapes.h"

#include "client/viewer/island/shape_shaders.h"

#include <GL/gl.h>
#include <GL/glext.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace evod::viewer {

namespace {

// Reads a shape, after shape.vert.glsl. The shader subtracts the camera's centre from a position before it multiplies
// by the zoom. The difference of nearby positions is exact in floats, but each product would be rounded.
constexpr const char* read_source = R"(
uniform samplerBuffer shapes;        // centre and half size; for lines and arrows, begin and end
uniform samplerBuffer colours;
uniform vec2 centre;
uniform float zoom;
Source read_source(int index) {
    vec4 shape = texelFetch(shapes, index);
    vec2 extent = shape.zw;
#if FORM == LINE || FORM == ARROW || FORM == SOFT_LINE
    extent -= shape.xy;
#endif
    vec4 colour = coloured ? texelFetch(colours, index) : vec4(0.0);
    return Source((shape.xy - centre) * zoom, extent * zoom, shape.w, colour);
}
)";

std::string with_form(const std::string& source, Form form, bool point) {
    constexpr std::array<const char*, form_count> names{"CIRCLE", "RECTANGLE", "LINE",   "ARROW",     "BODY",
                                                        "LEAF",   "STAR",      "RIPPLE", "SOFT_LINE", "TRIANGLE"};
    std::string text = "#version 330 core\n";
    for (std::size_t i = 0; i < names.size(); ++i) {
        text += "#define " + std::string{names[i]} + " " + std::to_string(i) + "\n";
    }
    return text + "#define BARE 0\n#define POINT " + (point ? "1" : "0") + "\n#define FORM " +
           names[static_cast<std::size_t>(form)] + "\n" + source;
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
    const unsigned vertex =
        compile(GL_VERTEX_SHADER, with_form(shape_vertex_source + std::string{read_source}, form, point));
    const unsigned fragment = compile(GL_FRAGMENT_SHADER, with_form(shape_fragment_source, form, point));
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
