// WorkerPane: one pane of the page in the worker: what it watches, what its canvas shows, and what it reports to the
// page.
import type {Subscription} from "../core/core_session";
import {type Camera, type FromWorker, type Look, none_left, type ToWorker} from "../core/messages";
import type {Snapshot} from "../core/snapshot";
import {Renderer} from "../render/renderer";
import type {Connection} from "./connection";
import {Feed} from "./feed";
import type {ForWall} from "./wall";

const report_ms = 50, drawing_report_ms = 200, tiles_report_ms = 300; // least time between two messages

/** The messages of the page about one pane. */
export type ForPane = Exclude<ToWorker, {
  kind: "connect" | "request" | "events_taken" | "visible" | "ask_figures" | "close_pane" | ForWall["kind"]
}>;

export class WorkerPane {
  readonly feed: Feed;
  readonly #number: number;
  readonly #post: (message: FromWorker) => void;
  #renderer: Renderer|null = null; // until the canvas has arrived
  // What the page has set before the canvas has arrived.
  readonly #settings:
    {size?: [width: number, height: number, pixel_ratio: number]; camera: Camera | null; look?: Look} = {camera: null};
  #undrawn: Snapshot[] = []; // added to the renderer, not acknowledged yet
  readonly #newest = new Map<number, Snapshot>(); // by island
  readonly #picks: Extract<ForPane, {kind: "pick"}>[] = []; // not answered yet
  #follows = false;
  #is_fresh = false; // a snapshot is not reported yet
  #are_tiles_fresh = false;
  #reported = {camera: "", drawing: "", tiles: ""}; // what the page knows, as text
  #reported_ms = {snapshot: 0, drawing: 0, tiles: 0};

  constructor(number: number, connection: Connection, post: (message: FromWorker) => void) {
    this.#number = number;
    this.#post = post;
    this.feed = new Feed(connection);
  }

  /** Subscribes to what the pane shows. Replaces the last subscriptions. */
  start(): void {
    this.#undrawn = [];
    this.feed.start(this.#renderer);
  }

  stop(): void {
    this.#undrawn = [];
    this.feed.stop();
  }

  /** The server has accepted the subscription, in a new session. */
  subscribed(): void {
    this.#renderer?.view.region.forget();
  }

  /** Takes a snapshot. Returns whether the pane draws it and acknowledges it afterwards. */
  take_snapshot(subscription: Subscription, snapshot: Snapshot, now_ms: number): boolean {
    if (subscription === this.feed.overview) {
      this.#renderer?.view.add_overview(snapshot);
      return true; // it needs no acknowledgement
    }
    if (subscription !== this.feed.subscription) {
      return false;
    }
    const {island} = snapshot.info;
    this.#newest.set(island, snapshot);
    this.#is_fresh ||= island === this.feed.watched?.island;
    this.#are_tiles_fresh = this.feed.islands > 0;
    this.#undrawn.push(snapshot);
    this.#renderer?.add(snapshot, now_ms);
    this.feed.follow_size(snapshot, this.#renderer);
    return true;
  }

  /** Draws if needed. Returns whether anything was drawn. */
  draw(now_ms: number, acknowledge: (subscription: Subscription, snapshot: Snapshot) => void): boolean {
    if (this.#undrawn.length === 0 && !this.needs_frame(now_ms)) {
      return false;
    }
    const newest = this.newest();
    if (newest && this.#is_report_due(now_ms)) {
      this.#renderer?.view.read(newest.info, now_ms); // so that this frame has the labels of the report that follows
    }
    this.#renderer?.draw(now_ms);
    this.#answer_picks();
    for (const snapshot of this.#undrawn.splice(0)) {
      if (this.feed.subscription) {
        acknowledge(this.feed.subscription, snapshot);
      }
    }
    if (this.#renderer) {
      this.feed.follow_camera(this.#renderer, now_ms);
    }
    return true;
  }

  needs_frame(now_ms: number): boolean {
    return this.#renderer?.needs_frame(now_ms) ?? false;
  }

  /** Reports what was drawn to the page. Returns whether something has to wait for a later frame. */
  report(now_ms: number): boolean {
    if (this.#renderer) {
      this.#report_drawing(this.#renderer, now_ms);
      this.#report_tiles(this.#renderer, now_ms);
    }
    const newest = this.newest();
    if (!this.#is_fresh || !newest || this.#undrawn.length > 0) {
      return this.#are_tiles_fresh;
    }
    if (!this.#is_report_due(now_ms)) {
      return true;
    }
    this.#is_fresh = false;
    this.#reported_ms.snapshot = now_ms;
    const view = this.#renderer?.view, selected = view?.settings.selected ?? null;
    this.#post({
      kind: "snapshot",
      pane: this.#number,
      info: newest.info,
      reading: view?.read(newest.info, now_ms) ?? {info: newest.info, healthiest: []},
      selected: view?.island.organism(selected) ?? null
    });
    return this.#are_tiles_fresh;
  }

  #is_report_due(now_ms: number): boolean {
    return this.#is_fresh && now_ms - this.#reported_ms.snapshot >= report_ms;
  }

  /** The newest snapshot of the chosen island. */
  newest(): Snapshot|null {
    return this.#newest.get(this.feed.watched?.island ?? 0) ?? null;
  }

  close(): void {
    this.stop();
    this.#renderer?.close();
  }

  take(message: ForPane): void {
    const renderer = this.#renderer;
    switch (message.kind) {
      case "pane":
        this.#take_canvas(message.canvas);
        break;
      case "resize":
        this.#settings.size = [message.width, message.height, message.pixel_ratio];
        renderer?.resize(...this.#settings.size);
        break;
      case "watch":
        this.#watch(message.world, message.island, message.rate_hz);
        break;
      case "unwatch":
        this.#forget_snapshots();
        this.feed.watch(null, this.feed.islands);
        break;
      case "islands":
        this.#show_islands(message.islands);
        break;
      case "camera":
        this.#settings.camera = message.camera;
        this.#reported.camera = JSON.stringify(message.camera);
        renderer?.change({camera: message.camera});
        break;
      case "pointer":
        renderer?.change({pointer: message.at, tool: message.tool});
        break;
      case "look":
        this.#settings.look = message.look;
        renderer?.set_look(message.look);
        break;
      case "select":
        this.#follows = message.follow;
        renderer?.change({selected: message.organism, hovered: message.hovered, follows: message.follow});
        this.#is_fresh = this.newest() !== null; // the page waits for the place of the selected organism
        break;
      case "population":
        renderer?.change({population: message.columns});
        break;
      case "pick":
        this.#picks.push(message);
        this.#answer_picks();
        break;
      case "ask_columns":
        this.#post({kind: "columns", id: message.id, columns: this.newest()});
        break;
      default:
        none_left(message);
    }
  }

  /** Answers the picks, those from before the first frame after it. */
  #answer_picks(): void {
    const view = this.#renderer?.view;
    if (view?.is_drawn && this.#settings.size) {
      for (const {id, x, y, radius} of this.#picks.splice(0)) {
        this.#post({kind: "picked", id, ...(view.pick(x, y, radius) ?? nothing_picked)});
      }
    }
  }

  #take_canvas(canvas: OffscreenCanvas): void {
    const renderer = (this.#renderer = new Renderer(canvas)), {size, camera, look} = this.#settings;
    if (size) {
      renderer.resize(...size);
    }
    if (look) {
      renderer.set_look(look);
    }
    renderer.change({camera});
    renderer.show_islands(this.feed.islands, this.feed.watched?.island ?? 0);
    for (const snapshot of this.#newest.values()) {
      renderer.add(snapshot, performance.now());
    }
    this.#is_fresh = this.#newest.size > 0; // the report without a canvas named no organisms
  }

  #watch(world: string, island: number, rate_hz: number): void {
    const before = this.feed.watched;
    if (this.feed.islands > 0 && before?.world === world && before.rate_hz === rate_hz) {
      before.island = island; // it is streamed already
      this.#renderer?.choose(island);
      this.#is_fresh = true;
      return;
    }
    this.#forget_snapshots();
    this.feed.watch({world, island, rate_hz}, this.feed.islands);
    this.#renderer?.choose(island);
    this.start();
  }

  /** Shows all islands as tiles, or only the chosen one, whose snapshots stay. */
  #show_islands(islands: number): void {
    if (islands === this.feed.islands) {
      return;
    }
    const {watched} = this.feed, chosen = watched?.island ?? 0;
    for (const island of this.#newest.keys()) {
      if (island !== chosen) {
        this.#newest.delete(island);
      }
    }
    this.#reported.tiles = "";
    this.feed.watch(watched, islands);
    this.#renderer?.show_islands(islands, chosen);
    this.start();
  }

  #forget_snapshots(): void {
    this.#newest.clear();
    this.#is_fresh = false;
    this.#renderer?.clear();
  }

  #report_drawing(renderer: Renderer, now_ms: number): void {
    const camera = this.#follows ? renderer.view.camera() : null;
    if (camera && this.feed.islands === 0) {
      this.#report("camera", JSON.stringify(camera), {kind: "camera", pane: this.#number, camera});
    }
    if (now_ms - this.#reported_ms.drawing >= drawing_report_ms) {
      const drawing = renderer.view.description.drawing;
      if (drawing && this.#report("drawing", JSON.stringify(drawing), {kind: "drawing", pane: this.#number, drawing})) {
        this.#reported_ms.drawing = now_ms;
      }
    }
  }

  #report_tiles(renderer: Renderer, now_ms: number): void {
    if (!this.#are_tiles_fresh || now_ms - this.#reported_ms.tiles < tiles_report_ms) {
      return;
    }
    this.#are_tiles_fresh = false;
    this.#reported_ms.tiles = now_ms;
    const tiles = renderer.tiles().map((info) => info && {
      generation: info.generation,
      alive: info.live?.alive_count ?? info.counts.organisms,
      health_mean: info.live?.health_mean ?? 0
    });
    this.#report("tiles", JSON.stringify(tiles), {kind: "tiles", pane: this.#number, tiles});
  }

  /** Posts what has changed since the last report. */
  #report(what: "camera"|"drawing"|"tiles", text: string, message: FromWorker): boolean {
    const has_changed = this.#reported[what] !== text;
    if (has_changed) {
      this.#reported[what] = text;
      this.#post(message);
    }
    return has_changed;
  }
}

const nothing_picked = {
  generation: 0,
  organism: null,
  food: null,
  poison: null,
  x_px: -1,
  y_px: -1
};
