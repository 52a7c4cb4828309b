// WallTiles: the worlds of a class as tiles. Each tile is a button; the worker draws the islands of all tiles
// in view on one canvas behind them.
import type {Look, WallTile} from "../core/messages";
import {wall_texts as texts} from "../texts/class";
import {fitness_text} from "../texts/numbers";
import type {Size} from "../render/camera";
import {observe_size} from "../widgets/canvas_size";
import {set_attribute} from "../widgets/controls";
import {h, set_text, svg} from "../widgets/dom";
import type {Server} from "../world/server";

import type {Student} from "./class_model";
import {type Order, sort_by} from "./standing";

const sorted_ms = 3000; // least time between two changes of the order, so that a tile can be hit
const gap_pixels = 8, tile_pixels_min = 104; // CSS pixels, as in class.css
const text_pixels = 72,
      island_aspect = 0.7; // what a tile contains besides its island, whose height follows from the width
const row_pixels_min = 112, row_pixels_scrolled = 150;
const curve_points = 60, curve_width = 100, curve_height = 24;

interface Tile {
  button: HTMLButtonElement;
  island: HTMLElement;
  name: HTMLElement;
  facts: HTMLElement;
  mark: HTMLElement;
  curve: SVGPathElement;
  curve_key: string;
}

export class WallTiles {
  readonly element: HTMLElement;
  order: Order = "name";
  readonly #canvas = h("canvas", {class: "wall-canvas", "aria-hidden": "true"});
  readonly #grid = h("div", {class: "wall-grid", role: "group", "aria-label": texts.tiles});
  readonly #tiles = new Map<string, Tile>(); // by world, in the shown order
  readonly #server: Server;
  readonly #look: () => Look;
  readonly #open: (world: string) => void;
  readonly #end_size: () => void;
  #focused = ""; // the world whose tile Tab reaches
  #sorted_ms = -Infinity;
  #sorted = "";
  #size: Size = {width: 1, height: 1}; // of the canvas
  #sent = "";
  #request = 0;

  /** look: as the page draws islands; open: shows the world of a student */
  constructor(server: Server, look: () => Look, open: (world: string) => void) {
    this.#server = server;
    this.#look = look;
    this.#open = open;
    this.element = h("div", {class: "wall-tiles"}, this.#canvas, this.#grid);
    this.#grid.addEventListener("keydown", (event) => this.#key(event));
    this.#grid.addEventListener("scroll", () => this.place());
    this.#end_size = observe_size(this.#canvas, (size, pixel_ratio) => {
      server.post({kind: "wall_size", ...size, pixel_ratio});
      this.#sent = "";
      this.#size = size;
      this.#lay_out();
    });
    if (new OffscreenCanvas(1, 1).getContext("webgl2") !== null) {
      const canvas = this.#canvas.transferControlToOffscreen();
      server.post({kind: "wall", canvas}, [canvas as unknown as Transferable]);
    }
  }

  close(): void {
    cancelAnimationFrame(this.#request);
    this.#end_size();
    this.#server.post({kind: "close_wall"});
  }

  /** Shows these students. */
  refresh(students: readonly Student[], is_frozen: boolean): void {
    const now_ms = performance.now(), key = students.map(({world, name}) => `${world} ${name}`).join() + this.order;
    const worlds = new Set(students.map(({world}) => world));
    for (const world of this.#tiles.keys()) {
      if (!worlds.has(world)) {
        this.#tiles.get(world)!.button.remove();
        this.#tiles.delete(world);
      }
    }
    if (key !== this.#sorted || (now_ms - this.#sorted_ms > sorted_ms && this.order !== "name")) {
      this.#sorted = key;
      this.#sorted_ms = now_ms;
      this.#sort(students);
    }
    students.forEach((student) => this.#write(student, is_frozen));
    this.#lay_out();
  }

  /** Chooses so many columns that all tiles are in view, if they are not too small then. */
  #lay_out(): void {
    const {width, height} = this.#size, {columns, row_pixels} = grid_of({width, height}, this.#tiles.size);
    this.#grid.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
    this.#grid.style.gridAutoRows = `${row_pixels}px`;
    this.place();
  }

  /** Focuses the tile of a world, or the first one. */
  focus(world = this.#focused): void {
    const tile = this.#tiles.get(world) ?? this.#tiles.values().next().value;
    tile?.button.focus();
  }

  /** Sends the worlds in view and their places to the worker, with the next frame. */
  place(): void {
    this.#request ||= requestAnimationFrame(() => {
      this.#request = 0;
      this.#place();
    });
  }

  #place(): void {
    const of_canvas = this.#canvas.getBoundingClientRect();
    if (of_canvas.width === 0) {
      return; // the wall is hidden
    }
    const tiles: WallTile[] = [];
    for (const [world, {island}] of this.#tiles) {
      const {left, top, width, height, bottom} = island.getBoundingClientRect();
      if (bottom > of_canvas.top && top < of_canvas.bottom && width > 0) {
        tiles.push({world, left: left - of_canvas.left, top: top - of_canvas.top, width, height});
      }
    }
    const look = this.#look(), sent = JSON.stringify([tiles, look]);
    if (sent !== this.#sent) {
      this.#sent = sent;
      this.#server.post({kind: "wall_tiles", tiles, look});
    }
  }

  #sort(students: readonly Student[]): void {
    const focused = document.activeElement, sorted = sort_by([...students], this.order);
    const before = [...this.#tiles.keys()].join(), order = sorted.map(({world}) => world);
    if (before === order.join()) {
      return;
    }
    const tiles = order.map((world): [string, Tile] => [world, this.#tiles.get(world) ?? this.#tile(world)]);
    this.#tiles.clear();
    tiles.forEach(([world, tile]) => this.#tiles.set(world, tile));
    this.#grid.replaceChildren(...tiles.map(([, {button}]) => button));
    if (focused instanceof HTMLElement && this.#grid.contains(focused)) {
      focused.focus({preventScroll: true}); // moving it has taken the focus
    }
    if (!this.#tiles.has(this.#focused)) {
      this.#focused = order[0] ?? "";
    }
  }

  #tile(world: string): Tile {
    const island = h("span", {class: "wall-island"}), name = h("span", {class: "wall-name"});
    const facts = h("span", {class: "wall-facts"}), mark = h("span", {class: "wall-mark", "aria-hidden": "true"});
    const curve = svg("path", {class: "wall-curve-line"});
    const image = svg(
      "svg", {
        class: "wall-curve",
        viewBox: `0 0 ${curve_width} ${curve_height}`,
        preserveAspectRatio: "none",
        "aria-hidden": "true"
      },
      curve);
    const button =
      h("button",
        {type: "button", class: "wall-tile", onclick: () => this.#open(world), onfocus: () => (this.#focused = world)},
        h("span", {class: "wall-head"}, mark, name), island, h("span", {class: "wall-foot"}, facts), image);
    return {button, island, name, facts, mark, curve, curve_key: ""};
  }

  #write(student: Student, is_frozen: boolean): void {
    const tile = this.#tiles.get(student.world);
    if (!tile) {
      return;
    }
    const {button, name, facts, mark} = tile, {member, info, standing} = student;
    const is_away = (member.sessions ?? 0) === 0, frozen = info?.frozen ?? is_frozen;
    const generation = info?.generation ?? 0, best = Number.isFinite(standing.best) ? fitness_text(standing.best) : "–";
    set_text(name, student.name);
    set_text(facts, texts.facts(generation, best));
    set_text(mark, [is_away ? "●" : "", frozen ? "❄" : ""].join(""));
    set_attribute(button, "data-away", is_away ? "" : null);
    set_attribute(button, "data-frozen", frozen ? "" : null);
    const state = [
      is_away ? texts.away : "", frozen ? texts.is_frozen : "", info === null ? texts.no_world : "",
      standing.stuck > 0 ? texts.stuck(standing.stuck) : ""
    ].filter(Boolean);
    const label = texts.tile(student.name, generation, best, state);
    set_attribute(button, "aria-label", label);
    set_attribute(button, "title", label);
    button.tabIndex = student.world === this.#focused ? 0 : -1;
    this.#draw_curve(tile, student);
  }

  #draw_curve(tile: Tile, {history}: Student): void {
    const y = history?.table.column(null, "fitness_best") ?? [], key = `${history?.table.revision} ${y.length}`;
    if (tile.curve_key !== key) {
      tile.curve_key = key;
      tile.curve.setAttribute("d", curve_path(y));
    }
  }

  /** Moves between the tiles by the arrow keys. */
  #key(event: KeyboardEvent): void {
    const worlds = [...this.#tiles.keys()], at = worlds.indexOf(this.#focused);
    const tops = [...this.#tiles.values()].map(({button}) => button.offsetTop);
    const columns = tops.lastIndexOf(tops[0] ?? 0) + 1, last = worlds.length - 1;
    const to = {
      ArrowLeft: at - 1,
      ArrowRight: at + 1,
      ArrowUp: at - columns,
      ArrowDown: at + columns,
      Home: 0,
      End: last
    }[event.key];
    if (to === undefined || event.ctrlKey || event.altKey || event.metaKey) {
      return;
    }
    event.preventDefault();
    const world = worlds[to];
    if (world !== undefined) {
      this.#tiles.get(this.#focused)!.button.tabIndex = -1;
      this.#tiles.get(world)!.button.tabIndex = 0;
      this.focus(world);
    }
  }
}

/** The columns and the height of the rows with which all tiles are in view and as large as possible; if they would be
 *  too small then, the grid scrolls. */
export function grid_of({width, height}: Size, count: number): {columns: number; row_pixels: number} {
  const columns_max = Math.max(1, Math.floor((width - gap_pixels) / (tile_pixels_min + gap_pixels)));
  const row_of = (columns: number): number => {
    const tile = (width - gap_pixels) / columns - gap_pixels, rows = Math.ceil(count / columns);
    return Math.min((height - gap_pixels) / rows - gap_pixels, tile * island_aspect + text_pixels);
  };
  let best = columns_max;
  for (let columns = columns_max; columns >= 1; --columns) {
    best = row_of(columns) >= row_of(best) ? columns : best;
  }
  const row = Math.floor(row_of(best));
  return row >= row_pixels_min ? {columns: best, row_pixels: row} :
                                 {columns: columns_max, row_pixels: row_pixels_scrolled};
}

/** A small curve without axes, in curve_points points at most. */
export function curve_path(y: readonly number[]): string {
  const step = Math.max(1, Math.ceil(y.length / curve_points)), points: number[] = [];
  for (let i = 0; i < y.length; i += step) {
    points.push(Math.max(...y.slice(i, i + step).filter((value) => Number.isFinite(value))));
  }
  const known = points.filter((value) => Number.isFinite(value));
  if (known.length < 2) {
    return "";
  }
  const low = Math.min(...known), high = Math.max(...known), range = high > low ? high - low : 1;
  return points
    .map(
      (value, i) => Number.isFinite(value) ?
        `${i === 0 ? "M" : "L"}${(curve_width * i / (points.length - 1)).toFixed(1)} ${
          (1 + (curve_height - 2) * (1 - (value - low) / range)).toFixed(1)}` :
        "")
    .join("")
    .replace(/^L/, "M");
}
