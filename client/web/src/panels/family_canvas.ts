// FamilyCanvas: paints a family tree on a canvas. Thousands of organisms and lines are one path per colour.
import type {AncestorsOfTwo, CommonAncestors} from "../family/common_ancestors";
import {is_copy} from "../family/lineage";
import type {FamilyTree, Place, Spot} from "../family/spot";
import {with_separators} from "../texts/numbers";
import {css_colours, type CssColours} from "../widgets/theme";
import type {Range} from "../widgets/visible_range";

export interface Scene {
  tree: FamilyTree;
  width: number; // of the canvas in CSS pixels
  colours: string[][]|null; // of each place of each row; null: the accent colour
  lines_in_colours: boolean; // lines have the colours of the children
  of_all: CommonAncestors|null;
  of_two: AncestorsOfTwo|null; // the lines to the two are emphasised
  marked: readonly Place[]; // at most two: A and B
  selected: Place|null; // the organism that the island shows as selected
  shown_generation: number; // its label is emphasised
}

/** Whether both scenes look alike. What is computed from the same tree and marks is the same object. */
export function same_scene(one: Scene, other: Scene): boolean {
  return one.tree === other.tree && one.width === other.width && one.colours === other.colours &&
    one.lines_in_colours === other.lines_in_colours && one.of_all === other.of_all && one.of_two === other.of_two &&
    one.marked === other.marked && one.shown_generation === other.shown_generation &&
    one.selected?.row === other.selected?.row && one.selected?.place === other.selected?.place;
}

const label_width = 46, margin = 8;
const curves_max = 6_000; // more lines are straight
const opacity_min = 0.06; // of lines that overlap much
const lines_per_path = 64; // overlapping lines add up only if they are in different paths

export function row_height_of(rows: number): number {
  return rows <= 20 ? 36 : rows <= 50 ? 24 : 18;
}

const theme_colours = {
  text: "--text",
  quiet: "--text-2",
  accent: "--accent",
  accent_text: "--accent-text",
  surface: "--surface",
  pointer: "--pointer",
  focus: "--focus",
  warn: "--warn",
};
type Theme = CssColours<typeof theme_colours>;

export function theme_of(element: Element): Theme {
  return css_colours(element, theme_colours);
}

/** Where the organisms of a tree are on a canvas of this width, in CSS pixels. */
export class FamilyLayout {
  readonly height: number;
  readonly row_height: number;
  readonly each: number; // between neighbours at the least distance
  readonly radius: number;

  constructor(readonly tree: FamilyTree, readonly width: number, readonly view: Range) {
    this.row_height = row_height_of(tree.rows.length);
    this.height = tree.rows.length * this.row_height + 8;
    this.each = (width - label_width - margin) / (view.max - view.min);
    this.radius = Math.min(11, this.row_height * 0.32, Math.max(1.2, this.each * 0.42));
  }

  x_of(spot: Spot): number {
    return label_width + (spot.x - this.view.min) * this.each;
  }

  y_of(row: number): number {
    return row * this.row_height + this.row_height / 2 + 4;
  }

  is_visible(x: number): boolean {
    return x >= label_width - 1 && x <= this.width;
  }

  /** The position in units of the tree. */
  unit_at(x: number): number {
    return this.view.min + (x - label_width) / this.each;
  }

  /** The organism nearest to a point, at most `reach` away. */
  nearest(x: number, y: number, reach: number): Place|null {
    let found: Place|null = null, least = reach;
    const row = Math.round((y - this.y_of(0)) / this.row_height);
    for (const i of [row - 1, row, row + 1]) {
      (this.tree.rows[i] ?? []).forEach((spot, place) => {
        const at = this.x_of(spot), distance = Math.hypot(at - x, this.y_of(i) - y);
        if (distance < least && this.is_visible(at)) {
          found = {row: i, place};
          least = distance;
        }
      });
    }
    return found;
  }
}

/** Lines of one colour. */
class Lines {
  length = 0; // of all, in CSS pixels
  #paths: Path2D[] = [];
  #count = 0;

  /** Returns the path to which a line of this length is to be added. */
  next(length: number): Path2D {
    this.length += length;
    if (this.#count++ % lines_per_path === 0) {
      this.#paths.push(new Path2D());
    }
    return this.#paths[this.#paths.length - 1]!;
  }

  stroke(context: CanvasRenderingContext2D, colour: string, width: number, opacity: number): void {
    context.globalAlpha = opacity;
    context.strokeStyle = colour;
    context.lineWidth = width;
    for (const path of this.#paths) {
      context.stroke(path);
    }
    context.globalAlpha = 1;
  }
}

/** One drawing of a scene. */
export class FamilyPainter {
  readonly #layout: FamilyLayout;
  readonly #scene: Scene;
  readonly #context: CanvasRenderingContext2D;
  readonly #theme: Theme;
  #curved = true;

  constructor(layout: FamilyLayout, scene: Scene, context: CanvasRenderingContext2D, theme: Theme) {
    this.#layout = layout;
    this.#scene = scene;
    this.#context = context;
    this.#theme = theme;
  }

  paint(): void {
    const context = this.#context, layout = this.#layout;
    context.clearRect(0, 0, layout.width, layout.height);
    context.save();
    context.beginPath();
    context.rect(label_width - 12, 0, layout.width, layout.height);
    context.clip();
    this.#paint_lines();
    this.#paint_organisms();
    this.#paint_marks();
    context.restore();
    this.#paint_labels();
  }

  /** Emphasises one organism and the lines to its parents and children. */
  paint_pointed_at(at: Place, colour: string): void {
    const context = this.#context, {rows} = this.#scene.tree, spot = rows[at.row]?.[at.place];
    if (!spot) {
      return;
    }
    const lines = new Lines(), above = rows[at.row - 1];
    for (const parent of [above?.[spot.first], above?.[spot.second]]) {
      if (parent) {
        this.#add_line(lines, at.row, spot, parent);
      }
    }
    for (const child of rows[at.row + 1] ?? []) {
      if (child.first === at.place || child.second === at.place) {
        this.#add_line(lines, at.row + 1, child, spot);
      }
    }
    lines.stroke(context, colour, 2, 1);
    this.#ring(at, this.#layout.radius + 3, colour, 3);
  }

  #add_line(lines: Lines, row: number, child: Spot, parent: Spot): void {
    const layout = this.#layout, from = layout.x_of(parent), to = layout.x_of(child);
    if (Math.max(from, to) < label_width || Math.min(from, to) > layout.width) {
      return;
    }
    const top = layout.y_of(row - 1), bottom = layout.y_of(row), middle = (top + bottom) / 2;
    const path = lines.next(Math.hypot(to - from, bottom - top));
    path.moveTo(from, top);
    if (this.#curved) {
      path.bezierCurveTo(from, middle, to, middle, to, bottom);
    } else {
      path.lineTo(to, bottom);
    }
  }

  #paint_lines(): void {
    const {tree, colours, lines_in_colours, of_two} = this.#scene, context = this.#context, layout = this.#layout;
    const visible = (layout.view.max - layout.view.min) / tree.width;
    this.#curved = tree.rows.reduce((sum, row) => sum + row.length, 0) * visible <= curves_max;
    const first = new Map<string, Lines>(), second = new Lines(), emphasised = new Lines();
    tree.rows.forEach((row, i) => row.forEach((spot, place) => {
      const colour = lines_in_colours && colours ? colours[i]![place]! : this.#theme.quiet;
      if (!first.has(colour)) {
        first.set(colour, new Lines());
      }
      const first_parent = tree.rows[i - 1]?.[spot.first], second_parent = tree.rows[i - 1]?.[spot.second];
      for (const [parent, lines] of [[first_parent, first.get(colour)!], [second_parent, second]] as const) {
        if (parent) {
          this.#add_line(lines, i, spot, parent);
        }
        if (parent && of_two?.between.has(spot) && of_two.between.has(parent)) {
          this.#add_line(emphasised, i, spot, parent);
        }
      }
    }));
    const length = [second, ...first.values()].reduce((sum, lines) => sum + lines.length, 0);
    const cover = length / (layout.width * layout.height); // lines of 1 px over each pixel
    const opacity = Math.min(1, Math.max(opacity_min, 1 / cover));
    second.stroke(context, this.#theme.quiet, cover > 1 ? 0.5 : 1, 0.6 * opacity);
    for (const [colour, lines] of first) {
      lines.stroke(context, colour, cover > 1 ? 1 : 2, 0.85 * opacity);
    }
    emphasised.stroke(context, this.#theme.pointer, 3, 1);
  }

  #paint_organisms(): void {
    const {tree, colours} = this.#scene, layout = this.#layout, context = this.#context, radius = layout.radius;
    const shapes = new Map < string, {
      filled: Path2D;
      hollow: Path2D
    }
    > ();
    tree.rows.forEach((row, i) => row.forEach((spot, place) => {
      const x = layout.x_of(spot), y = layout.y_of(i);
      if (!layout.is_visible(x)) {
        return;
      }
      const colour = colours?.[i]![place] ?? this.#theme.accent;
      if (!shapes.has(colour)) {
        shapes.set(colour, {filled: new Path2D(), hollow: new Path2D()});
      }
      const {filled, hollow} = shapes.get(colour)!, {ancestor} = spot, first_parent = ancestor.parents[0];
      const path = is_copy(ancestor) && radius >= 2.5 ? hollow : filled;
      if (first_parent && first_parent.island !== ancestor.island && radius >= 2.5) {
        diamond(path, x, y, radius + 1);
      } else if (radius < 2) {
        path.rect(x - radius, y - 3, 2 * radius, 6);
      } else {
        path.moveTo(x + radius, y);
        path.arc(x, y, radius, 0, 2 * Math.PI);
      }
    }));
    for (const [colour, {filled, hollow}] of shapes) {
      if (colours && radius >= 2) { // an edge, because some colours are as dark as the background, or as light
        context.strokeStyle = this.#theme.quiet;
        context.lineWidth = 1.5;
        context.stroke(filled);
        context.lineWidth = Math.min(5, radius);
        context.stroke(hollow);
      }
      context.fillStyle = colour;
      context.fill(filled);
      context.fillStyle = this.#theme.surface;
      context.fill(hollow);
      context.strokeStyle = colour;
      context.lineWidth = Math.min(3, radius / 2);
      context.stroke(hollow);
    }
    if (radius >= 9) {
      this.#paint_ids();
    }
  }

  #paint_ids(): void {
    const {tree, colours} = this.#scene, layout = this.#layout, context = this.#context;
    context.font = `11px ${getComputedStyle(context.canvas).fontFamily}`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    tree.rows.forEach((row, i) => row.forEach((spot, place) => {
      const x = layout.x_of(spot), y = layout.y_of(i);
      context.fillStyle = is_copy(spot.ancestor) ? this.#theme.text :
        colours                                  ? text_on(colours[i]![place]!) :
                                                   this.#theme.accent_text;
      if (layout.is_visible(x)) {
        context.fillText(String(spot.ancestor.organism), x, y + 0.5);
      }
    }));
  }

  #paint_marks(): void {
    const {of_all, of_two, marked, selected} = this.#scene, radius = this.#layout.radius;
    for (const common of [of_all, of_two]) {
      for (const place of common?.places ?? []) {
        this.#ring({row: common!.row, place}, radius + 3, this.#theme.text, 1.5);
        this.#ring({row: common!.row, place}, radius + 6, this.#theme.text, 1.5);
      }
    }
    if (selected) {
      this.#ring(selected, radius + 1, this.#theme.pointer, 4);
    }
    marked.forEach((at, i) => {
      this.#ring(at, radius + 2, this.#theme.pointer, 2);
      const spot = this.#scene.tree.rows[at.row]![at.place]!, context = this.#context;
      const x = this.#layout.x_of(spot) + radius + 9, y = this.#layout.y_of(at.row);
      context.font = `bold 12px ${getComputedStyle(context.canvas).fontFamily}`;
      context.textAlign = "center";
      context.textBaseline = "middle";
      context.strokeStyle = this.#theme.surface;
      context.lineWidth = 4;
      context.strokeText(i === 0 ? "A" : "B", x, y);
      context.fillStyle = this.#theme.text;
      context.fillText(i === 0 ? "A" : "B", x, y);
    });
  }

  #ring({row, place}: Place, radius: number, colour: string, width: number): void {
    const spot = this.#scene.tree.rows[row]?.[place], context = this.#context;
    if (spot && this.#layout.is_visible(this.#layout.x_of(spot))) {
      context.beginPath();
      context.arc(this.#layout.x_of(spot), this.#layout.y_of(row), radius, 0, 2 * Math.PI);
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.stroke();
    }
  }

  #paint_labels(): void {
    const {tree, shown_generation} = this.#scene, layout = this.#layout, context = this.#context;
    const family = getComputedStyle(context.canvas).fontFamily;
    context.textAlign = "left";
    context.textBaseline = "middle";
    tree.rows.forEach((_, i) => {
      const generation = tree.first_generation + i, is_shown = generation === shown_generation;
      context.font = `${is_shown ? "bold " : ""}12px ${family}`;
      context.fillStyle = is_shown ? this.#theme.warn : this.#theme.quiet;
      context.fillText(with_separators(generation), 2, layout.y_of(i), label_width - 6);
    });
  }
}

function diamond(path: Path2D, x: number, y: number, size: number): void {
  path.moveTo(x, y - size);
  path.lineTo(x + size, y);
  path.lineTo(x, y + size);
  path.lineTo(x - size, y);
  path.closePath();
}

/** Black or white, whichever is easier to read on a colour such as "rgb(1, 2, 3)". */
function text_on(colour: string): string {
  const [red = 0, green = 0, blue = 0] = (colour.match(/\d+/g) ?? []).map(Number);
  return 0.299 * red + 0.587 * green + 0.114 * blue > 140 ? "#000" : "#fff";
}
