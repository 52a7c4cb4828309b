// GlSurface: a canvas with a WebGL2 context, whose shaders and glyphs all islands on it share.
import {pane_frame, type Size} from "./camera";
import {GlIsland} from "./gl_island";
import {GlShapes} from "./gl_shapes";
import {GlText} from "./gl_text";
import type {Colour} from "./look";
import type {Painter, Surface} from "./scene";

export class GlSurface implements Surface {
  readonly #shapes: GlShapes;
  readonly #text: GlText;

  constructor(gl: WebGL2RenderingContext) {
    this.#shapes = new GlShapes(gl);
    this.#text = new GlText(this.#shapes);
  }

  painter(): Painter {
    return new GlIsland(this.#shapes, this.#text);
  }

  fill({width, height}: Size, ratio: number, colour: Colour): void {
    this.#shapes.begin({left: 0, top: 0, width, height, ratio, frame: pane_frame, is_tile: false, has_details: true});
    this.#shapes.fill(0, 0, width * ratio, height * ratio, colour);
  }

  close(): void {
    this.#shapes.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
}
