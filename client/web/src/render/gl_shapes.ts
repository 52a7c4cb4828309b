// GlShapes: draws many shapes of one kind in one call with WebGL2. Tables keep the shapes in graphics memory.
import type {Place} from "./camera";
import type {Colour, ShapeStyle} from "./look";
import {
  fragment_shader,
  glyph_fragment_shader,
  glyph_vertex_shader,
  quad_fragment_shader,
  quad_vertex_shader,
  Variant,
  vertex_shader
} from "./shaders";

const row_texels = 1024;

/** An array of integers in graphics memory, as a texture. Only rows that have changed are uploaded. The texture grows
 *  geometrically. */
export class Table {
  readonly #texture: WebGLTexture;
  #data = new Int32Array(0);
  #rows = 0;

  readonly #gl: WebGL2RenderingContext;
  readonly #channels: 2|4;

  constructor(gl: WebGL2RenderingContext, channels: 2|4) {
    this.#gl = gl;
    this.#channels = channels;
    this.#texture = gl.createTexture()!;
    this.bind();
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    this.#grow(1, null);
  }

  bind(): void {
    this.#gl.activeTexture(this.#gl.TEXTURE0);
    this.#gl.bindTexture(this.#gl.TEXTURE_2D, this.#texture);
  }

  close(): void {
    this.#gl.deleteTexture(this.#texture);
  }

  /** Replaces the first `texels` texels. */
  update(source: Int32Array, texels: number): void {
    const row = row_texels * this.#channels;
    const end = texels * this.#channels;
    const rows = Math.ceil(texels / row_texels);
    this.bind();
    if (rows > this.#rows) {
      this.#grow(Math.max(rows, 2 * this.#rows), source.subarray(0, end));
      return;
    }
    let changed_from = -1;
    for (let i = 0; i < rows; ++i) {
      const begin = i * row;
      const row_end = Math.min(begin + row, end);
      let at = begin;
      while (at < row_end && this.#data[at] === source[at]) {
        ++at;
      }
      if (at < row_end) {
        for (; at < row_end; ++at) {
          this.#data[at] = source[at]!;
        }
        changed_from = changed_from < 0 ? i : changed_from;
      } else if (changed_from >= 0) {
        this.#upload(changed_from, i);
        changed_from = -1;
      }
    }
    if (changed_from >= 0) {
      this.#upload(changed_from, rows);
    }
  }

  #upload(from_row: number, to_row: number): void {
    const gl = this.#gl;
    const format = this.#channels === 4 ? gl.RGBA_INTEGER : gl.RG_INTEGER;
    gl.texSubImage2D(
      gl.TEXTURE_2D, 0, 0, from_row, row_texels, to_row - from_row, format, gl.INT, this.#data,
      from_row * row_texels * this.#channels);
  }

  #grow(rows: number, contents: Int32Array|null): void {
    const gl = this.#gl;
    this.#rows = rows;
    this.#data = new Int32Array(rows * row_texels * this.#channels);
    if (contents !== null) {
      this.#data.set(contents);
    }
    const [inner, format] = this.#channels === 4 ? [gl.RGBA32I, gl.RGBA_INTEGER] : [gl.RG32I, gl.RG_INTEGER];
    gl.texImage2D(gl.TEXTURE_2D, 0, inner, row_texels, rows, 0, format, gl.INT, this.#data);
  }
}

/** A texture of bytes: cells of densities, or the atlas of glyphs. */
export class Cells {
  readonly #texture: WebGLTexture;
  #width = 0;
  #height = 0;

  readonly #gl: WebGL2RenderingContext;

  constructor(gl: WebGL2RenderingContext) {
    this.#gl = gl;
    this.#texture = gl.createTexture()!;
    this.bind();
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  }

  close(): void {
    this.#gl.deleteTexture(this.#texture);
  }

  bind(unit: 0|1 = 0): void {
    this.#gl.activeTexture(unit === 0 ? this.#gl.TEXTURE0 : this.#gl.TEXTURE1);
    this.#gl.bindTexture(this.#gl.TEXTURE_2D, this.#texture);
  }

  /** `bytes`: red, green, blue and alpha of each cell, row after row. */
  set(bytes: Uint8Array, width: number, height: number): void {
    const gl = this.#gl;
    this.bind();
    if (width > this.#width || height > this.#height) {
      this.#width = Math.max(width, this.#width);
      this.#height = Math.max(height, this.#height);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, this.#width, this.#height, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
    }
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes, 0);
  }
}

/** How positions become pixels of the canvas. */
export interface Projection {
  centre_x: number; // in steps; need not be whole
  centre_y: number;
  origin_x: number; // the pixel of the centre
  origin_y: number;
  zoom: number; // device pixels per step
}

export interface DrawOptions {
  moving?: boolean;
  item_half?: number; // in device pixels; for items
  heading_beyond?: number; // in device pixels; for headings
  stride?: 1|2;
  coloured?: boolean;
  blend?: number;
  health_share?: number;
  fill?: Colour; // instead of the one of the style
  edge_pixels?: number; // instead of those of the style
  half_pixels_min?: number; // instead of those of the style
  line_pixels?: number; // instead of those of the style
  half_max?: number; // of the largest shape, in device pixels; absent: unknown
  as_points?: boolean; // if all shapes are small enough
}

interface Program {
  name: WebGLProgram;
  uniforms: {[name: string]: WebGLUniformLocation|null};
}

const uniform_names = [
  "shapes",
  "stride",
  "coloured",
  "pixel_size",
  "origin",
  "centre",
  "centre_fraction",
  "zoom",
  "blend",
  "health_share",
  "item_half",
  "heading_beyond",
  "half_pixels_min",
  "line_pixels",
  "edge_pixels",
  "fill",
  "fill_low",
  "edge",
];

function build(gl: WebGL2RenderingContext, vertex: string, fragment: string, uniforms: readonly string[]): Program {
  const name = gl.createProgram()!;
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]] as const) {
    const shader = gl.createShader(kind)!;
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(name, shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) {
      throw new Error(`a shader was refused: ${gl.getShaderInfoLog(shader) ?? ""}`);
    }
    gl.deleteShader(shader);
  }
  gl.linkProgram(name);
  if (!gl.getProgramParameter(name, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error(`the shaders do not fit: ${gl.getProgramInfoLog(name) ?? ""}`);
  }
  return {
    name,
    uniforms: Object.fromEntries(uniforms.map((uniform) => [uniform, gl.getUniformLocation(name, uniform)]))
  };
}

export class GlShapes {
  readonly #programs = new Map<string, Program>();
  readonly #quad: Program;
  readonly #glyphs: Program;
  readonly #point_pixels_max: number;
  #left = 0; // the lower left corner of the place, in device pixels from that of the canvas
  #bottom = 0;
  #width = 1;
  #height = 1;
  #ratio = 1;

  constructor(readonly gl: WebGL2RenderingContext) {
    const sizes = gl.getParameter(gl.ALIASED_POINT_SIZE_RANGE) as Float32Array;
    this.#point_pixels_max = Math.min(sizes[1] ?? 1, 10);
    this.#quad = build(gl, quad_vertex_shader, quad_fragment_shader, ["pixel_size", "rectangle", "cells", "size"]);
    this.#glyphs = build(
      gl, glyph_vertex_shader, glyph_fragment_shader, ["pixel_size", "glyphs", "cell", "atlas", "tint", "is_halo"]);
  }

  /** Draws into a rectangle of the canvas: all coordinates count from its upper left corner, in device pixels, and
   *  nothing is drawn outside. `place` is in CSS pixels. */
  begin({left, top, width, height, ratio}: Place): void {
    const gl = this.gl;
    this.#ratio = ratio;
    this.#left = Math.round(left * ratio);
    this.#width = Math.max(Math.round(width * ratio), 1);
    this.#height = Math.max(Math.round(height * ratio), 1);
    this.#bottom = gl.drawingBufferHeight - Math.round(top * ratio) - this.#height;
    gl.viewport(this.#left, this.#bottom, this.#width, this.#height);
    gl.enable(gl.SCISSOR_TEST);
    gl.disable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    this.clip_to_place();
  }

  /** Restricts drawing to a rectangle of the place, in device pixels. */
  clip(left: number, top: number, right: number, bottom: number): void {
    const x0 = Math.round(Math.min(Math.max(left, 0), this.#width));
    const x1 = Math.round(Math.min(Math.max(right, 0), this.#width));
    const y0 = Math.round(Math.min(Math.max(top, 0), this.#height));
    const y1 = Math.round(Math.min(Math.max(bottom, 0), this.#height));
    this.gl.scissor(this.#left + x0, this.#bottom + this.#height - y1, Math.max(x1 - x0, 0), Math.max(y1 - y0, 0));
  }

  clip_to_place(): void {
    this.clip(0, 0, this.#width, this.#height);
  }

  /** Fills a rectangle of the place in whole pixels. Ends a clip(). */
  fill(left: number, top: number, right: number, bottom: number, colour: Colour): void {
    this.clip(left, top, right, bottom);
    this.gl.clearColor(colour[0] / 255, colour[1] / 255, colour[2] / 255, 1);
    this.gl.clear(this.gl.COLOR_BUFFER_BIT);
    this.clip_to_place();
  }

  draw(table: Table|null, count: number, style: ShapeStyle, projection: Projection, options: DrawOptions): void {
    if (table === null || count === 0) {
      return;
    }
    const gl = this.gl, ratio = this.#ratio;
    const edge_pixels = (options.edge_pixels ?? style.edge_pixels) * ratio;
    const half_pixels_min = (options.half_pixels_min ?? style.half_pixels_min) * ratio;
    const half_max = Math.max(options.half_max ?? Infinity, half_pixels_min);
    const has_tips = style.form === "leaf" || style.form === "star" || style.form === "triangle";
    const bare =
      style.form === "body" && (edge_pixels === 0 || half_max < 0.8 * edge_pixels); // as in the vertex shader
    const rim = style.form === "body" && !bare ? Math.min(edge_pixels, 0.4 * half_max) : 0;
    const reach = half_max + 0.5 + (has_tips ? 0.5 + 0.5 * half_max : 1.6 * rim);
    const variant = {
      form: style.form,
      moving: options.moving === true,
      item: options.item_half !== undefined,
      bare,
      heading: options.heading_beyond !== undefined,
      point: options.as_points === true && 2 * reach <= this.#point_pixels_max &&
        (has_tips || style.form === "circle" || style.form === "body"),
    };
    const {name, uniforms} = this.#program_of(variant);
    const whole_x = Math.floor(projection.centre_x);
    const whole_y = Math.floor(projection.centre_y);
    gl.useProgram(name);
    gl.uniform1i(uniforms.shapes!, 0);
    gl.uniform1i(uniforms.stride!, options.stride ?? (options.moving ? 2 : 1));
    gl.uniform1i(uniforms.coloured!, options.coloured ? 1 : 0);
    gl.uniform2f(uniforms.pixel_size!, 2 / this.#width, 2 / this.#height);
    gl.uniform2f(uniforms.origin!, projection.origin_x, projection.origin_y);
    gl.uniform2i(uniforms.centre!, whole_x, whole_y);
    gl.uniform2f(uniforms.centre_fraction!, projection.centre_x - whole_x, projection.centre_y - whole_y);
    gl.uniform1f(uniforms.zoom!, projection.zoom);
    gl.uniform1f(uniforms.blend!, options.blend ?? 1);
    gl.uniform1f(uniforms.health_share!, options.health_share ?? 0);
    gl.uniform1f(uniforms.item_half!, options.item_half ?? 0);
    gl.uniform1f(uniforms.heading_beyond!, options.heading_beyond ?? 0);
    gl.uniform1f(uniforms.half_pixels_min!, half_pixels_min);
    gl.uniform1f(uniforms.line_pixels!, (options.line_pixels ?? style.line_pixels) * ratio);
    gl.uniform1f(uniforms.edge_pixels!, edge_pixels);
    this.#set_colour(uniforms.fill!, options.fill ?? style.fill);
    this.#set_colour(uniforms.fill_low!, style.fill_low);
    this.#set_colour(uniforms.edge!, style.edge);
    table.bind();
    gl.drawArrays(variant.point ? gl.POINTS : gl.TRIANGLES, 0, variant.point ? count : 3 * count);
  }

  /** Draws columns x rows cells into a rectangle, in device pixels. */
  draw_cells(cells: Cells, columns: number, rows: number, left: number, top: number, width: number, height: number):
    void {
    const gl = this.gl;
    const {name, uniforms} = this.#quad;
    gl.useProgram(name);
    gl.uniform1i(uniforms.cells!, 0);
    gl.uniform2f(uniforms.pixel_size!, 2 / this.#width, 2 / this.#height);
    gl.uniform4f(uniforms.rectangle!, left, top, width, height);
    gl.uniform2i(uniforms.size!, columns, rows);
    cells.bind();
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }

  /** Draws the halos of all glyphs, then the glyphs, so that no halo covers a neighbour. */
  draw_glyphs(
    table: Table, count: number, atlas: Cells, cell_width: number, cell_height: number, ink: Colour,
    halo: Colour): void {
    if (count === 0) {
      return;
    }
    const gl = this.gl;
    const {name, uniforms} = this.#glyphs;
    gl.useProgram(name);
    gl.uniform1i(uniforms.glyphs!, 0);
    gl.uniform1i(uniforms.atlas!, 1);
    gl.uniform2f(uniforms.pixel_size!, 2 / this.#width, 2 / this.#height);
    gl.uniform2i(uniforms.cell!, cell_width, cell_height);
    table.bind();
    atlas.bind(1);
    for (const is_halo of [1, 0]) {
      gl.uniform1i(uniforms.is_halo!, is_halo);
      this.#set_colour(uniforms.tint!, is_halo ? halo : ink);
      gl.drawArrays(gl.TRIANGLES, 0, 6 * count);
    }
  }

  #set_colour(location: WebGLUniformLocation|null, colour: Colour): void {
    this.gl.uniform4f(location, colour[0] / 255, colour[1] / 255, colour[2] / 255, colour[3] / 255);
  }

  #program_of(variant: Variant): Program {
    const key = Object.values(variant).join(" ");
    let program = this.#programs.get(key);
    if (program === undefined) {
      program = build(this.gl, vertex_shader(variant), fragment_shader(variant), uniform_names);
      this.#programs.set(key, program);
    }
    return program;
  }
}
