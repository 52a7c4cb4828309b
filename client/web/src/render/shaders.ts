// Shaders: draw circles, rectangles, lines and arrows, one triangle or point each. The text that evoview shares is in
// client/shaders.
//
// The vertex shader reads the shape with index gl_VertexID / 3 from a texture of integers (vertex pulling).
//
// Texels of a shape: (x, y, w, h), and for "paired" shapes also (previous x, previous y, headings, colour). Positions
// are in steps; the shader subtracts the camera's centre from them as integers, which is exact, before it multiplies by
// the zoom.
import shape_frag from "../../../shaders/shape.frag.glsl";
import shape_vert from "../../../shaders/shape.vert.glsl";
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

const forms: readonly Form[] =
  ["circle", "rectangle", "line", "arrow", "body", "leaf", "star", "ripple", "soft_line", "triangle"];

function header(variant: Variant): string {
  return "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp isampler2D;\n" +
    forms.map((form, i) => `#define ${form.toUpperCase()} ${i}\n`).join("") +
    `#define FORM ${variant.form.toUpperCase()}\n#define MOVING ${Number(variant.moving)}\n#define ITEM ${
           Number(variant.item)}\n` +
    `#define HEADING ${Number(variant.heading)}\n#define POINT ${Number(variant.point)}\n` +
    `#define BARE ${Number(variant.bare)}\n`;
}

/** Reads a shape, after shape.vert.glsl. */
const read_source = `
uniform isampler2D shapes;           // 1,024 texels wide
uniform int stride;                  // texels of a shape: 1 or 2
uniform ivec2 centre;                // of the camera, in steps
uniform vec2 centre_fraction;        // the rest of it
uniform float zoom;                  // pixels per step
uniform float blend;
uniform float health_share;          // of full health per step
uniform float item_half;             // half size of items, in pixels
uniform float heading_beyond;        // from the outline to the end of the line, in pixels
ivec4 texel(int i) {
  return texelFetch(shapes, ivec2(i & 1023, i >> 10), 0);
}
Source read_source(int index) {
  ivec4 shape = texel(index * stride);
  Source source = Source(vec2(0.0), vec2(0.0), 0.0, vec4(0.0));
#if !ITEM
  ivec4 more = ivec4(0);
  if (MOVING == 1 || coloured) {
    more = texel(index * stride + 1);
  }
  if (coloured) {
    uint packed = uint(more.w);
    source.colour = vec4(packed & 255u, (packed >> 8) & 255u, (packed >> 16) & 255u, packed >> 24) / 255.0;
  }
#endif
#if MOVING
  source.middle = (vec2(more.xy - centre) + vec2(shape.xy - more.xy) * blend - centre_fraction) * zoom;
#else
  source.middle = (vec2(shape.xy - centre) - centre_fraction) * zoom;
#endif
#if ITEM
  source.extent = vec2(item_half);
#elif HEADING
  float heading = float(more.z & 255), turned = float(((more.z & 255) - ((more.z >> 8) & 255) + 128 & 255) - 128);
  float angle = (heading - (1.0 - blend) * turned) * 6.2831853 / 256.0;
  vec2 ahead = vec2(cos(angle), sin(angle));
  float radius = float(shape.z) * zoom;
  source.middle += ahead * 0.35 * radius;
  source.extent = ahead * (0.65 * radius + heading_beyond);
#elif FORM == LINE || FORM == ARROW || FORM == SOFT_LINE
  source.extent = vec2(shape.zw - shape.xy) * zoom;
#else
  source.extent = vec2(shape.zw) * zoom;
#endif
#if FORM == BODY || FORM == TRIANGLE
  source.health = min(float(shape.w) * health_share, 1.0);
#endif
  return source;
}
`;

export function vertex_shader(variant: Variant): string {
  return header(variant) + shape_vert + read_source;
}

export function fragment_shader(variant: Variant): string {
  return header(variant) + shape_frag;
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
