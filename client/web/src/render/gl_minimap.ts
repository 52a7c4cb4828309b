// GlMinimap: draws the minimap of an island with WebGL2.
import {Cells, type GlShapes} from "./gl_shapes";
import {with_room} from "./interpolator";
import type {Scene} from "./scene";

export class GlMinimap {
  readonly #shapes: GlShapes;
  #cells: Cells|null = null; // until the minimap is shown first
  #key = ""; // for what the cells were filled
  #bytes = new Uint8Array(0);

  constructor(shapes: GlShapes) {
    this.#shapes = shapes;
  }

  close(): void {
    this.#cells?.close();
  }

  draw({minimap, colours, place: {ratio}, look}: Scene): void {
    if (minimap === null) {
      return;
    }
    const {place, frame, grid, scale} = minimap, shapes = this.#shapes;
    const cells = (this.#cells ??= new Cells(shapes.gl));
    const left = place.screen.left * ratio;
    const top = place.screen.top * ratio;
    const right = left + place.screen.width * ratio;
    const bottom = top + place.screen.height * ratio;
    const key = `${minimap.version} ${look.skin} ${look.background}`;
    if (key !== this.#key) {
      this.#key = key;
      const size = grid.columns * grid.rows;
      const bytes = (this.#bytes = with_room(this.#bytes, 4 * size));
      for (let i = 0; i < size; ++i) {
        const count = grid.counts[i]!;
        const alpha = count === 0 ? 0 : (60 + 195 * Math.min(count / scale.high, 1)) / 255;
        for (let channel = 0; channel < 3; ++channel) {
          bytes[4 * i + channel] = colours.body[channel]! * alpha;
        }
        bytes[4 * i + 3] = 255 * alpha;
      }
      cells.set(bytes, grid.columns, grid.rows);
    }
    const pixel = Math.max(Math.round(ratio), 1);
    shapes.fill(left - pixel, top - pixel, right + pixel, bottom + pixel, colours.wall);
    shapes.fill(left, top, right, bottom, colours.ground);
    shapes.clip(left, top, right, bottom);
    const cell = grid.cell_px * place.zoom * ratio;
    shapes.draw_cells(cells, grid.columns, grid.rows, left, top, grid.columns * cell, grid.rows * cell);
    shapes.clip_to_place();
    const [x0, y0] = [frame.left * ratio, frame.top * ratio];
    const [x1, y1] = [x0 + frame.width * ratio, y0 + frame.height * ratio];
    const thick = 2 * pixel;
    shapes.fill(x0, y0, x1, y0 + thick, colours.selected);
    shapes.fill(x0, y1 - thick, x1, y1, colours.selected);
    shapes.fill(x0, y0, x0 + thick, y1, colours.selected);
    shapes.fill(x1 - thick, y0, x1, y1, colours.selected);
  }
}
