// Shaders: draw circles, rectangles, lines and arrows, one triangle or point each, as in evoview
// (client/viewer/island/shapes.cpp).
//
// The vertex shader reads the shape with index gl_VertexID / 3 from a texture of integers (vertex pulling). The
// fragment shader computes how much of a pixel a shape covers from its distance to the outline, so shapes are smooth at
// any zoom.
//
// Texels of a shape: (x, y, w, h), and for "paired" shapes also (previous x, previous y, headings, colour). Positions
// are in steps; the shader subtracts the camera's centre from them as integers, which is exact, before it multiplies by
// the zoom.
import type {Form} from "./look";

export interface Variant {
  form: Form;
  /** two texels per shape, drawn between the previous and the present position */
  moving: boolean;
  /** x and y only; the size is a uniform */
  item: boolean;
  /** the heading of an organism, as a line */
  heading: boolean;
  /** gl.POINTS instead of triangles */
  point: boolean;
  /** bodies of which none is large enough for an arc */
  bare: boolean;
}

const forms: readonly Form[] = ["circle", "rectangle", "line", "arrow", "body", "leaf", "star", "ripple", "soft_line"];

function header(variant: Variant): string {
  return "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp isampler2D;\n" +
    forms.map((form, i) => `#define ${form.toUpperCase()} ${i}\n`).join("") +
    `#define FORM ${variant.form.toUpperCase()}\n#define MOVING ${Number(variant.moving)}\n#define ITEM ${
           Number(variant.item)}\n` +
    `#define HEADING ${Number(variant.heading)}\n#define POINT ${Number(variant.point)}\n` +
    `#define BARE ${Number(variant.bare)}\n`;
}

export function vertex_shader(variant: Variant): string {
  return header(variant) + `
uniform isampler2D shapes;           // 1,024 texels wide
uniform int stride;                  // texels of a shape: 1 or 2
uniform bool coloured;               // whether each shape has its own colour
uniform vec2 pixel_size;             // size of one pixel in clip space
uniform vec2 origin;                 // centre of the camera on the canvas, in pixels
uniform ivec2 centre;                // of the camera, in steps
uniform vec2 centre_fraction;        // the rest of it
uniform float zoom;                  // pixels per step
uniform float blend;
uniform float health_share;          // of full health per step
uniform float item_half;             // half size of items, in pixels
uniform float heading_beyond;        // from the outline to the end of the line, in pixels
uniform float half_pixels_min, line_pixels, edge_pixels;
uniform vec4 fill, fill_low;
#if POINT
flat out float reach;                // half the size of the point, in pixels
#else
out vec2 place;                      // offset from the shape's centre, in pixels, along the shape's axes
#endif
flat out vec2 half_size;
flat out vec4 own_fill;
#if FORM == BODY && !BARE
flat out vec3 arc;                   // of a body: direction across the end of the arc; health
flat out float rim;                  // of a body: width of the arc; 0: none
#endif
ivec4 texel(int i) {
  return texelFetch(shapes, ivec2(i & 1023, i >> 10), 0);
}
void main() {
  int index = POINT == 1 ? gl_VertexID : gl_VertexID / 3;
  ivec4 shape = texel(index * stride);
  own_fill = fill;
#if !ITEM
  ivec4 more = ivec4(0);
  if (MOVING == 1 || coloured) {
    more = texel(index * stride + 1);
  }
  if (coloured) {
    uint packed = uint(more.w);
    own_fill = vec4(packed & 255u, (packed >> 8) & 255u, (packed >> 16) & 255u, packed >> 24) / 255.0;
  }
#endif
#if MOVING
  vec2 middle = (vec2(more.xy - centre) + vec2(shape.xy - more.xy) * blend - centre_fraction) * zoom;
#else
  vec2 middle = (vec2(shape.xy - centre) - centre_fraction) * zoom;
#endif
  vec2 along = vec2(1.0, 0.0), around = vec2(0.5);
#if ITEM
  half_size = vec2(max(item_half, half_pixels_min));
#else
  half_size = max(vec2(shape.zw) * zoom, vec2(half_pixels_min));
#endif
#if HEADING
  float heading = float(more.z & 255), turned = float(((more.z & 255) - ((more.z >> 8) & 255) + 128 & 255) - 128);
  float angle = (heading - (1.0 - blend) * turned) * 6.2831853 / 256.0;
  along = vec2(cos(angle), sin(angle));
  float radius = float(shape.z) * zoom, begin = 0.35 * radius, end = radius + heading_beyond;
  middle += along * (begin + end) / 2.0;
  half_size = vec2(end - begin, line_pixels) / 2.0;
  around += vec2(line_pixels);
#elif FORM == LINE || FORM == ARROW || FORM == SOFT_LINE
  vec2 way = vec2(shape.zw - shape.xy) * zoom;
  float pixels = length(way);
  middle += way / 2.0;
  along = pixels > 0.0 ? way / pixels : along;
  half_size = vec2(pixels, line_pixels) / 2.0;
  around += FORM == ARROW ? vec2(line_pixels, 2.5 * line_pixels) : vec2(line_pixels);
#elif FORM == BODY
  float health = min(float(shape.w) * health_share, 1.0);
  half_size = half_size.xx;
#if !BARE
  rim = half_size.x < 0.8 * edge_pixels ? 0.0 : min(edge_pixels, 0.4 * half_size.x); // a small body has no arc
  around += 1.6 * rim;
  arc = vec3(cos(6.2831853 * health), sin(6.2831853 * health), health);
#endif
  own_fill = coloured ? own_fill : mix(fill_low, fill, health);
#elif FORM == LEAF || FORM == STAR
  around += 0.5 + 0.5 * half_size;
#elif FORM == CIRCLE
  half_size = half_size.xx;
#endif
#if POINT
  bool is_dot = half_size.x <= 0.5; // fills the pixel at its centre
  reach = is_dot ? 0.5 : half_size.x + around.x;
  gl_PointSize = 2.0 * reach;
  vec2 pixel = is_dot ? floor(origin + middle) + 0.5 : origin + middle;
#else
  int corner_index = gl_VertexID % 3; // one triangle covers the rectangle around the shape
  vec2 corner = vec2(corner_index == 1, corner_index == 2) * 4.0 - 1.0;
  place = corner * (half_size + around);
  vec2 pixel = origin + middle + along * place.x + vec2(-along.y, along.x) * place.y;
#endif
  gl_Position = vec4(pixel.x * pixel_size.x - 1.0, 1.0 - pixel.y * pixel_size.y, 0.0, 1.0);
}
`;
}

export function fragment_shader(variant: Variant): string {
  return header(variant) + `
#if POINT
flat in float reach;
#define place ((2.0 * gl_PointCoord - 1.0) * reach)
#else
in vec2 place;
#endif
flat in vec2 half_size;
flat in vec4 own_fill;
#if FORM == BODY && !BARE
flat in vec3 arc;
flat in float rim;
#endif
uniform vec4 edge;
uniform float edge_pixels, line_pixels;
out vec4 colour;                     // with premultiplied alpha
float covered(float outside) {
  return clamp(0.5 - outside, 0.0, 1.0);
}
#if FORM == BODY && BARE
void main() {
  float from_centre = length(place), share = from_centre / half_size.x;
  colour = vec4(own_fill.rgb * (1.0 - 0.2 * share * share), 1.0) * own_fill.a * covered(from_centre - half_size.x);
}
#elif FORM == BODY
void main() {
  float radius = half_size.x, from_centre = length(place);
  float outer = radius + 1.6 * rim, share = from_centre / radius;
  float before_end = -dot(place, arc.xy), after_begin = place.x;
  float within = arc.z < 0.5 ? min(after_begin, before_end) : max(after_begin, before_end);
  float lit = arc.z <= 0.0 ? 0.0 : arc.z >= 1.0 ? 1.0 : clamp(within + 0.5, 0.0, 1.0);
  float ring = covered(from_centre - outer) - covered(from_centre - outer + rim);
  colour = vec4(own_fill.rgb * (1.0 - 0.2 * share * share), 1.0) * own_fill.a * covered(from_centre - radius) +
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
`;
}

/** A rectangle with a texture whose texels are cells. */
export const quad_vertex_shader = `#version 300 es
precision highp float;
uniform vec2 pixel_size;
uniform vec4 rectangle;              // left, top, width, height in pixels
out vec2 share;
void main() {
  share = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  vec2 pixel = rectangle.xy + share * rectangle.zw;
  gl_Position = vec4(pixel.x * pixel_size.x - 1.0, 1.0 - pixel.y * pixel_size.y, 0.0, 1.0);
}
`;
export const quad_fragment_shader = `#version 300 es
precision highp float;
uniform sampler2D cells;
uniform ivec2 size;                  // of the used part of the texture
in vec2 share;
out vec4 colour;                     // with premultiplied alpha
void main() {
  colour = texelFetch(cells, clamp(ivec2(share * vec2(size)), ivec2(0), size - 1), 0);
}
`;

/** Glyphs: x, y of the upper left corner in pixels, number of the glyph, colour of the text. */
export const glyph_vertex_shader = `#version 300 es
precision highp float;
precision highp int;
precision highp isampler2D;
uniform isampler2D glyphs;
uniform vec2 pixel_size;
uniform ivec2 cell;                  // size of a glyph in the atlas, in pixels
out vec2 place;                      // in the atlas, in pixels
void main() {
  int index = gl_VertexID / 6, corner = gl_VertexID % 6;
  ivec4 glyph = texelFetch(glyphs, ivec2(index & 1023, index >> 10), 0);
  vec2 share = vec2(corner == 1 || corner == 4 || corner == 5, corner == 2 || corner == 3 || corner == 5);
  vec2 pixel = vec2(glyph.xy) + share * vec2(cell);
  place = vec2(glyph.z * cell.x, 0) + share * vec2(cell);
  gl_Position = vec4(pixel.x * pixel_size.x - 1.0, 1.0 - pixel.y * pixel_size.y, 0.0, 1.0);
}
`;
export const glyph_fragment_shader = `#version 300 es
precision highp float;
uniform sampler2D atlas;             // red: the glyph; green: the halo around it
uniform vec4 tint;
uniform bool is_halo;
in vec2 place;
out vec4 colour;                     // with premultiplied alpha
void main() {
  vec4 cover = texelFetch(atlas, ivec2(place), 0);
  colour = vec4(tint.rgb, 1.0) * tint.a * (is_halo ? cover.g : cover.r);
}
`;
