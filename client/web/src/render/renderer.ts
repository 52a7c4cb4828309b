// Renderer: draws one pane with WebGL2: one island, or all islands of a world as tiles.
//
// The worker owns it, calls add() after each decoded snapshot and draw() from requestAnimationFrame while needs_frame()
// is true, and acknowledges a snapshot after the draw() that follows it.
import type {Look} from "../core/messages";
import type {Snapshot, SnapshotInfo} from "../core/snapshot";
import {pane_frame, type Place, type Size} from "./camera";
import {GlSurface} from "./gl_surface";
import {default_settings, IslandView, type ViewSettings} from "./island_view";
import {colours_of, default_look} from "./look";
import type {Surface} from "./scene";
import {island_place, tile_places} from "./tiles";

/** The surface of a canvas; on_restored: called with another one after the browser has restored a lost context. */
export function surface_of(canvas: OffscreenCanvas, on_restored: (surface: Surface|null) => void): Surface {
  const gl = canvas.getContext("webgl2", {alpha: false, antialias: false, depth: false, stencil: false});
  if (gl === null) { // the page gives no canvas to the worker if WebGL2 is missing
    throw new Error("this browser offers no WebGL2 in a worker");
  }
  canvas.addEventListener("webglcontextlost", (event) => {
    event.preventDefault(); // asks the browser to restore the context
    on_restored(null);
  });
  canvas.addEventListener("webglcontextrestored", () => on_restored(new GlSurface(gl)));
  return new GlSurface(gl);
}

export class Renderer {
  /** The chosen island, which the page describes. */
  view: IslandView;
  #surface: Surface|null; // null while the graphics context is lost
  #tiles: IslandView[]|null = null; // one per island; null: only `view`
  #look = default_look("vivid", "dark");
  #size: Size = {width: 1, height: 1};
  #ratio = 1;
  #aspect = 1; // of the islands in tiles
  #is_dirty = true; // something besides the islands has changed

  /** surface: is drawn to instead of the canvas, for tests. */
  constructor(readonly canvas: OffscreenCanvas, surface: Surface|null = null) {
    this.#surface = surface ?? surface_of(canvas, (other) => this.#replace_surface(other));
    this.view = new IslandView(default_settings(this.#whole()), this.#surface.painter());
  }

  /** Sets the size in CSS pixels and the device pixels per CSS pixel. */
  resize(width: number, height: number, pixel_ratio: number): void {
    this.#size = {width: Math.max(width, 1), height: Math.max(height, 1)};
    this.#ratio = pixel_ratio;
    const device_width = Math.max(Math.round(width * pixel_ratio), 1);
    const device_height = Math.max(Math.round(height * pixel_ratio), 1);
    if (this.canvas.width !== device_width || this.canvas.height !== device_height) {
      this.canvas.width = device_width;
      this.canvas.height = device_height;
    }
    this.#lay_out();
  }

  /** Shows all islands of the world as tiles; 0: only `view`. */
  show_islands(islands: number, chosen: number): void {
    if (islands === (this.#tiles?.length ?? 0)) {
      this.choose(chosen);
      return;
    }
    const settings = {...this.view.settings, ...none_chosen};
    this.#tiles?.forEach((tile) => tile !== this.view && tile.painter?.close());
    this.#tiles = islands === 0 ?
      null :
      Array.from(
        {length: islands},
        (_, i) => i === chosen ? this.view : new IslandView(settings, this.#surface?.painter() ?? null));
    this.set_look(this.#look);
    this.#lay_out();
  }

  /** Makes the tile of an island `view`. */
  choose(island: number): void {
    const next = this.#tiles?.[island];
    if (next !== undefined && next !== this.view) {
      next.change({...this.view.settings, place: next.settings.place, ...none_chosen});
      this.view.change(none_chosen);
      this.view = next;
    }
  }

  change(settings: Partial<Omit<ViewSettings, "place"|"look">>): void {
    this.view.change(settings);
  }

  set_look(look: Look): void {
    this.#look = look;
    const shown = this.#tiles === null ? look : look_of_tiles(look);
    this.#all().forEach((view) => view.change({look: shown}));
  }

  /** Shows a snapshot. `now_ms`: performance.now() when it arrived. */
  add(snapshot: Snapshot, now_ms: number): void {
    const {island, width_px, height_px} = snapshot.info;
    const view = this.#tiles === null ? this.view : this.#tiles[island];
    view?.add(snapshot, now_ms);
    if (this.#tiles !== null && this.#aspect !== width_px / height_px) {
      this.#lay_out();
    }
  }

  /** Drops the snapshots. Call it before another world or island is shown. */
  clear(): void {
    this.#all().forEach((view) => view.clear());
  }

  /** Whether draw() would draw something else than the last time. */
  needs_frame(now_ms: number): boolean {
    return this.#surface !== null && (this.#is_dirty || this.#all().some((view) => view.needs_frame(now_ms)));
  }

  draw(now_ms: number): void {
    if (this.#surface === null) { // the graphics context is lost; it will be restored
      return;
    }
    this.#is_dirty = false;
    if (this.#tiles !== null) { // the canvas forgets what it showed, so all are drawn
      this.#surface.fill(this.#size, this.#ratio, colours_of(this.#look).outside);
      const health_max = Math.max(...this.#tiles.map(({island}) => island.health_max));
      this.#tiles.forEach(({island}) => (island.health_max = health_max)); // so that tiles can be compared
    }
    this.#all().forEach((view) => view.draw(now_ms));
  }

  /** What the newest snapshot of each tile says; null before the first. */
  tiles(): (SnapshotInfo|null)[] {
    return this.#tiles?.map((tile) => tile.island.at.latest.info) ?? [];
  }

  /** Frees the graphics memory. */
  close(): void {
    this.#surface?.close();
    this.#surface = null;
  }

  #replace_surface(surface: Surface|null): void {
    this.#surface = surface;
    this.#is_dirty = true;
    this.#all().forEach((view) => (view.painter = surface?.painter() ?? null));
  }

  #all(): IslandView[] {
    return this.#tiles ?? [this.view];
  }

  #whole(): Place {
    return {left: 0, top: 0, ...this.#size, ratio: this.#ratio, frame: pane_frame, is_tile: false, has_details: true};
  }

  #lay_out(): void {
    this.#is_dirty = true;
    const {size} = this.view.island;
    this.#aspect = size === null ? this.#aspect : size.width / size.height;
    if (this.#tiles === null) {
      this.view.change({place: this.#whole()});
      return;
    }
    const places = tile_places(this.#size, this.#tiles.length, this.#aspect);
    this.#tiles.forEach((tile, i) => tile.change({place: island_place(places[i]!, this.#ratio)}));
  }
}

/** Tiles show no details, and colours only for what is known of all islands. */
export function look_of_tiles(look: Look): Look {
  return {...look, colour_by: look.colour_by === "health" ? "health" : "", minimap: false};
}

const none_chosen = {
  selected: null,
  hovered: null,
  pointer: null,
  follows: false
};
