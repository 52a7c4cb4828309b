// WorkerWall: the wall of a class in the worker: the first island of each shown world, as tiles on one canvas with one
// graphics context.
//
// Rate  The server sends rate_hz snapshots per second of each world. All tiles are drawn together, at most every
//       frame_ms, and without interpolation.
import type {Subscription} from "../core/core_session";
import {none_left, type ToWorker, type WallTile} from "../core/messages";
import type {Detail} from "../core/protocol";
import type {Snapshot} from "../core/snapshot";
import type {Place, Size} from "../render/camera";
import {default_settings, IslandView} from "../render/island_view";
import {colours_of, default_look} from "../render/look";
import {look_of_tiles, surface_of} from "../render/renderer";
import type {Surface} from "../render/scene";
import {tile_place} from "../render/tiles";
import type {Connection} from "./connection";

const rate_hz = 5, frame_ms = 100, unacknowledged_max = 2;
const dots_pixels = 150; // narrower islands are streamed as dots

export type ForWall = Extract<ToWorker, {kind: "wall" | "wall_size" | "wall_tiles" | "close_wall"}>;

interface Shown {
  view: IslandView;
  subscription: Subscription|null;
  undrawn: Snapshot[]; // not acknowledged yet
  detail: Detail; // of the subscription
}

export class WorkerWall {
  readonly #connection: Connection;
  readonly #shown = new Map<string, Shown>(); // by world
  #canvas: OffscreenCanvas|null = null;
  #surface: Surface|null = null; // null while there is no canvas or its graphics context is lost
  #look = look_of_tiles(default_look("vivid", "dark"));
  #size: Size = {width: 1, height: 1};
  #ratio = 1;
  #is_dirty = false;
  #drawn_ms = 0;

  constructor(connection: Connection) {
    this.#connection = connection;
  }

  take(message: ForWall): void {
    switch (message.kind) {
      case "wall":
        this.#canvas = message.canvas;
        this.#replace_surface(surface_of(message.canvas, (other) => this.#replace_surface(other)));
        this.#resize();
        break;
      case "wall_size":
        this.#size = {width: message.width, height: message.height};
        this.#ratio = message.pixel_ratio;
        this.#resize();
        break;
      case "wall_tiles":
        this.#look = {...look_of_tiles(message.look), interpolate: false, trails: false, flashes: false};
        this.#show(message.tiles);
        break;
      case "close_wall":
        this.#show([]);
        this.#surface?.close();
        this.#surface = this.#canvas = null;
        break;
      default:
        none_left(message);
    }
    this.#is_dirty = true;
  }

  /** Subscribes in a session of another user. */
  start(): void {
    this.#shown.forEach((shown, world) => this.#subscribe(shown, world));
  }

  /** Subscribes again after stop(). */
  start_missing(): void {
    this.#shown.forEach((shown, world) => shown.subscription ?? this.#subscribe(shown, world));
  }

  stop(): void {
    this.#shown.forEach((shown) => this.#unsubscribe(shown));
  }

  /** Takes a snapshot. Returns whether the wall draws it and acknowledges it afterwards. */
  take_snapshot(subscription: Subscription, snapshot: Snapshot, now_ms: number): boolean {
    for (const shown of this.#shown.values()) {
      if (shown.subscription === subscription) {
        shown.view.add(snapshot, now_ms);
        shown.undrawn.push(snapshot);
        this.#is_dirty = true;
        return true;
      }
    }
    return false;
  }

  /** Whether something has changed since the last draw(). */
  get needs_frame(): boolean {
    return this.#is_dirty && this.#surface !== null;
  }

  /** Draws if needed and due. Returns whether anything was drawn. */
  draw(now_ms: number, acknowledge: (subscription: Subscription, snapshot: Snapshot) => void): boolean {
    if (!this.needs_frame || now_ms - this.#drawn_ms < frame_ms) {
      return false;
    }
    this.#is_dirty = false;
    this.#drawn_ms = now_ms;
    this.#surface!.fill(this.#size, this.#ratio, colours_of(this.#look).outside);
    for (const {view, subscription, undrawn} of this.#shown.values()) {
      view.draw(now_ms);
      for (const snapshot of undrawn.splice(0)) {
        if (subscription) {
          acknowledge(subscription, snapshot);
        }
      }
    }
    return true;
  }

  /** Shows these worlds, and no others. */
  #show(tiles: readonly WallTile[]): void {
    const worlds = new Set(tiles.map(({world}) => world));
    for (const [world, shown] of this.#shown) {
      if (!worlds.has(world)) {
        this.#unsubscribe(shown);
        shown.view.painter?.close();
        this.#shown.delete(world);
      }
    }
    for (const tile of tiles) {
      const place = tile_place(tile, this.#ratio), known = this.#shown.get(tile.world);
      const shown = known ?? this.#added(tile.world, place), detail = detail_of(place);
      shown.view.change({place, look: this.#look});
      if (shown.subscription === null || shown.detail !== detail) {
        shown.detail = detail;
        this.#subscribe(shown, tile.world);
      }
    }
    this.#connection.flush();
  }

  #added(world: string, place: Place): Shown {
    const view = new IslandView(default_settings(place), this.#surface?.painter() ?? null);
    const shown: Shown = {view, subscription: null, undrawn: [], detail: "DETAIL_UNSPECIFIED"};
    this.#shown.set(world, shown);
    return shown;
  }

  #subscribe(shown: Shown, world: string): void {
    this.#unsubscribe(shown);
    const {core, may_stream} = this.#connection;
    if (core && !core.failed && may_stream) {
      shown.subscription = core.subscriptions.subscribe({
        subscribe_snapshots: {
          world,
          island: 0,
          rate_hz,
          codec: "CODEC_DELTA",
          unacknowledged_max,
          ...(shown.detail === "DETAIL_FULL" ? {headings: true, species: true} : {view: {detail: shown.detail}})
        }
      });
      this.#connection.flush();
    }
  }

  #unsubscribe(shown: Shown): void {
    if (shown.subscription) {
      this.#connection.core?.subscriptions.unsubscribe(shown.subscription);
      this.#connection.flush();
    }
    shown.subscription = null;
    shown.undrawn = [];
  }

  #resize(): void {
    if (this.#canvas) {
      this.#canvas.width = Math.max(Math.round(this.#size.width * this.#ratio), 1);
      this.#canvas.height = Math.max(Math.round(this.#size.height * this.#ratio), 1);
    }
  }

  #replace_surface(surface: Surface|null): void {
    this.#surface = surface;
    this.#is_dirty = true;
    this.#shown.forEach(({view}) => (view.painter = surface?.painter() ?? null));
  }
}

function detail_of({width}: Place): Detail {
  return width < dots_pixels ? "DETAIL_DOTS" : "DETAIL_FULL";
}
