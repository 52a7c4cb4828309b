#define GL_GLEXT_PROTOTYPES
#include "client/viewer/island/shapes.h"

#include <GL/gl.h>
#include <GL/glext.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace evod::viewer {

namespace {

// The shader subtracts the camera's centre from a position before it multiplies by the zoom. The difference of nearby
// positions is exact in floats, but each product would be rounded.
constexpr const char* vertex_source = R"(#version 330 core
uniform samplerBuffer shapes;        // centre and half size; for lines and arrows, begin and end
uniform samplerBuffer colours;
uniform int form;                    // Form
uniform bool coloured;               // whether each shape has its own colour
uniform vec2 pixel_size;             // size of one pixel in clip space
uniform vec2 origin;                 // centre of the viewport, in pixels
uniform vec2 centre;
uniform float zoom, half_pixels_min, line_pixels;
uniform vec4 fill;
out vec2 place;                      // offset from the shape's centre, in pixels, along the shape's axes
flat out vec2 half_size;
flat out vec4 own_fill;
void main() {
    int index = gl_VertexID / 3;
    vec4 shape = texelFetch(shapes, index);
    own_fill = coloured ? texelFetch(colours, index) : fill;
    vec2 middle = (shape.xy - centre) * zoom, along = vec2(1.0, 0.0), around = vec2(1.0);
    half_size = max(shape.zw * zoom, vec2(half_pixels_min));
    if (form >= 2) {
        vec2 way = (shape.zw - shape.xy) * zoom;
        float pixels = length(way);
        middle += way / 2.0;
        along = pixels > 0.0 ? way / pixels : along;
        half_size = vec2(pixels, line_pixels) / 2.0;
        around += form == 3 ? vec2(line_pixels, 5.0) : vec2(line_pixels);
    }
    int corner_index = gl_VertexID % 3; // one triangle covers the rectangle around the shape
    vec2 corner = vec2(corner_index == 1, corner_index == 2) * 4.0 - 1.0;
    place = corner * (half_size + around);
    vec2 pixel = origin + middle + along * place.x + vec2(-along.y, along.x) * place.y;
    gl_Position = vec4(pixel.x * pixel_size.x - 1.0, 1.0 - pixel.y * pixel_size.y, 0.0, 1.0);
}
)";

// The shader computes how much of a pixel a shape covers from the distance between the pixel's centre and the outline.
constexpr const char* fragment_source = R"(#version 330 core
in vec2 place;
flat in vec2 half_size;
flat in vec4 own_fill;
uniform int form;
uniform vec4 edge;
uniform float edge_pixels;
out vec4 colour;                     // with premultiplied alpha
float distance_outside() {
    vec2 beyond = abs(place) - half_size;
    if (form == 0) {
        return length(place) - half_size.x;
    }
    if (form == 1) {
        return max(beyond.x, beyond.y);
    }
    float outside = length(vec2(max(beyond.x, 0.0), place.y)) - half_size.y;
    if (form == 3) {
        float head = min(9.0, half_size.x), behind_tip = half_size.x - place.x;
        outside = min(outside, max((abs(place.y) - behind_tip / 2.0) * 0.894, behind_tip - head));
    }
    return outside;
}
void main() {
    float outside = distance_outside();
    float whole = clamp(0.5 - outside, 0.0, 1.0);
    float inner = clamp(0.5 - outside - edge_pixels, 0.0, 1.0);
    colour = vec4(edge.rgb, 1.0) * edge.a * (whole - inner) + vec4(own_fill.rgb, 1.0) * own_fill.a * inner;
}
)";

unsigned compile(GLenum kind, const char* source) {
    const unsigned shader = glCreateShader(kind);
    glShaderSource(shader, 1, &source, nullptr);
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
    const unsigned vertex = compile(GL_VERTEX_SHADER, vertex_source);
    const unsigned fragment = compile(GL_FRAGMENT_SHADER, fragment_source);
    program_ = glCreateProgram();
    glAttachShader(program_, vertex);
    glAttachShader(program_, fragment);
    glLinkProgram(program_);
    glDeleteShader(vertex);
    glDeleteShader(fragment);
    glGenVertexArrays(1, &vertex_array_);
    const auto uniform = [this](const char* name) { return glGetUniformLocation(program_, name); };
    pixel_size_ = uniform("pixel_size");
    origin_ = uniform("origin");
    centre_ = uniform("centre");
    zoom_ = uniform("zoom");
    form_ = uniform("form");
    coloured_ = uniform("coloured");
    fill_ = uniform("fill");
    edge_ = uniform("edge");
    edge_pixels_ = uniform("edge_pixels");
    half_pixels_min_ = uniform("half_pixels_min");
    line_pixels_ = uniform("line_pixels");
    glUseProgram(program_);
    glUniform1i(uniform("shapes"), 0);
    glUniform1i(uniform("colours"), 1);
    glUseProgram(0);
}

ShapePainter::~ShapePainter() {
    glDeleteVertexArrays(1, &vertex_array_);
    glDeleteProgram(program_);
}

void ShapePainter::begin(const Camera& camera, unsigned width_pixels, unsigned height_pixels, Colour background) {
    glViewport(0, 0, static_cast<int>(width_pixels), static_cast<int>(height_pixels));
    const Rectangle& viewport = camera.viewport();
    const auto pixel = [](double value) { return static_cast<int>(std::lround(value)); };
    glEnable(GL_SCISSOR_TEST);
    glScissor(pixel(viewport.left), pixel(height_pixels - viewport.top - viewport.height), pixel(viewport.width),
              pixel(viewport.height));
    glClearColor(background.red / 255.f, background.green / 255.f, background.blue / 255.f, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);

    const Point middle = viewport.centre(), centre = camera.centre();
    glUseProgram(program_);
    glBindVertexArray(vertex_array_);
    glUniform2f(pixel_size_, 2.f / static_cast<float>(width_pixels), 2.f / static_cast<float>(height_pixels));
    glUniform2f(origin_, static_cast<float>(middle.x), static_cast<float>(middle.y));
    glUniform2f(centre_, static_cast<float>(centre.x), static_cast<float>(centre.y));
    glUniform1f(zoom_, static_cast<float>(camera.zoom()));
}

void ShapePainter::draw(const Layer& layer, const ShapeStyle& style) {
    if (layer.count_ == 0) {
        return;
    }
    glUniform1i(form_, static_cast<int>(style.form));
    glUniform1i(coloured_, layer.coloured_);
    set_colour(fill_, style.fill);
    set_colour(edge_, style.edge);
    glUniform1f(edge_pixels_, style.edge_pixels);
    glUniform1f(half_pixels_min_, style.half_pixels_min);
    glUniform1f(line_pixels_, style.line_pixels);
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_BUFFER, layer.colours_.texture);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_BUFFER, layer.shapes_.texture);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(3 * layer.count_));
}

void ShapePainter::end() {
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_BUFFER, 0);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_BUFFER, 0);
    glBindVertexArray(0);
    glUseProgram(0);
    glDisable(GL_SCISSOR_TEST);
}

} // namespace evod::viewer
