// GlText: draws labels with WebGL2, from an atlas of glyphs. All islands of a canvas share it.
import {Cells, type GlShapes, Table} from "./gl_shapes";
import {Glyphs} from "./glyphs";
import {with_room} from "./interpolator";
import {with_alpha} from "./look";
import type {Scene} from "./scene";

export class GlText {
  readonly #shapes: GlShapes;
  readonly #table: Table;
  readonly #atlas: Cells;
  #glyphs: Glyphs|null = null;
  #staging = new Int32Array(0);

  constructor(shapes: GlShapes) {
    this.#shapes = shapes;
    this.#table = new Table(shapes.gl, 4);
    this.#atlas = new Cells(shapes.gl);
  }

  measure(text: string, ratio: number): number {
    return this.#glyphs_at(ratio).measure(text);
  }

  draw({labels, place: {ratio}, colours}: Scene): void {
    if (labels.length === 0) {
      return;
    }
    const glyphs = this.#glyphs_at(ratio);
    this.#staging = with_room(this.#staging, 4 * labels.reduce((sum, {text}) => sum + text.length, 0));
    let count = 0;
    for (const {text, left, top} of labels) {
      let x = Math.round(left * ratio) - glyphs.padding;
      const y = Math.round(top * ratio) - glyphs.padding;
      for (const character of text) {
        const index = glyphs.index_of(character);
        this.#staging[4 * count] = x;
        this.#staging[4 * count + 1] = y;
        this.#staging[4 * count + 2] = index;
        this.#staging[4 * count + 3] = 0;
        ++count;
        x += glyphs.advance(index);
      }
    }
    this.#table.update(this.#staging, count);
    this.#shapes.draw_glyphs(
      this.#table, count, this.#atlas, glyphs.cell_width, glyphs.cell_height, colours.label,
      with_alpha(colours.ground, 210));
  }

  #glyphs_at(ratio: number): Glyphs {
    if (this.#glyphs === null || this.#glyphs.ratio !== ratio) {
      this.#glyphs = new Glyphs(ratio);
      this.#atlas.set(this.#glyphs.bytes, this.#glyphs.cell_width * this.#glyphs.columns, this.#glyphs.cell_height);
    }
    return this.#glyphs;
  }
}
