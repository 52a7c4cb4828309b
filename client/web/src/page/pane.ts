// Pane: the canvas of one shown world: its view, its pointer, the tiles of all its islands, hints and the legend.
//
// The pane sends "pane", "close_pane", "resize", "camera", "islands", "pointer" and "pick" to the worker, which draws.
// ViewedWorld sends "watch", "look", "select" and "population".
import type {PopulationView} from "../panels/population_view";
import type {Drawing, FromWorker, Tool} from "../core/messages";
import type {Point, Size} from "../render/camera";
import {pane_texts} from "../texts/pane";
import {set_attribute} from "../widgets/controls";
import {observe_size} from "../widgets/canvas_size";
import {h, set_text} from "../widgets/dom";
import type {Notify} from "../widgets/notices";
import type {ViewedWorld} from "../world/world";
import {Gestures, type GestureTarget} from "./gestures";
import {IslandLegend} from "./island_legend";
import {IslandTiles} from "./island_tiles";
import {PaneTool} from "./pane_tool";
import {PaneView} from "./pane_view";
import {Picker, type Picked} from "./picker";

export interface PaneOptions {
  world: ViewedWorld;
  notify: Notify;
  /** Called when the user presses or focuses the pane. */
  on_focus?(): void;
  /** Called when the user has selected an organism in the pane. */
  on_select?(): void;
  /** Called after the user has placed something in the pane. */
  on_placed?(): void;
  /** Called after the tool was changed, by set_tool() or by the pane. */
  on_tool?(): void;
  /** Called after the view has moved, and after the size of the island is known first. */
  on_view?(view: PaneView, why: "moved"|"known"): void;
}

const double_click_ms = 350, double_click_pixels = 20;
const hint_offset = 16, hint_margin = 4; // of the hint from the pointer and from the edges

export class Pane {
  readonly element: HTMLElement; // fills its container
  readonly view: PaneView;
  readonly tool: PaneTool;
  readonly tiles: IslandTiles;

  readonly #canvas =
    h("canvas", {class: "pane-canvas", tabindex: 0, role: "application", "aria-roledescription": pane_texts.kind});
  readonly #legend = new IslandLegend();
  #population: Promise<PopulationView>|null = null; // null before an island without bodies is shown
  readonly #hint = h("div", {class: "pane-hint", "aria-hidden": "true", hidden: true});
  readonly #note = h("p", {class: "pane-note", role: "status", hidden: true});
  readonly #options: PaneOptions;
  readonly #world: ViewedWorld;
  readonly #gestures: Gestures;
  readonly #ends: (() => void)[] = [];
  readonly #picker: Picker;
  #pick: Promise<Picked>|null = null; // what was at the pressed point
  #last_click: {at: Point; ms: number; selected: number | null}|null = null;
  #pointer: Point|null = null; // of a mouse or pen over the canvas
  #sent_pointer = "";

  constructor(options: PaneOptions) {
    this.#options = options;
    this.#world = options.world;
    this.view = new PaneView(this.#world, (view) => options.on_view?.(view, "moved"));
    this.tool = new PaneTool(this.#world, () => this.#tool_changed());
    this.tiles = new IslandTiles(this.#world, (had_focus) => this.#tiles_changed(had_focus));
    this.element =
      h("div", {class: "pane"}, this.#canvas, this.#legend.element, this.#hint, this.#note, this.tiles.element,
        h("div", {class: "pane-focus"}));
    this.#picker = new Picker(this.#world.feed.pane, (message) => this.#world.server.post(message));
    this.#gestures = new Gestures(this.#canvas, this.#target());
    this.#canvas.addEventListener("pointerdown", () => options.on_focus?.());
    this.#canvas.addEventListener("focus", () => options.on_focus?.());
    this.#canvas.addEventListener("keydown", (event) => this.#key_down(event));
    this.#ends.push(
      observe_size(this.#canvas, (size, pixel_ratio) => this.#resized(size, pixel_ratio)),
      this.#world.server.messages.listen((message) => this.#take(message)),
      this.#world.changes.listen(() => this.#refresh()));
    if (new OffscreenCanvas(1, 1).getContext("webgl2") === null) {
      set_text(this.#note, pane_texts.no_webgl);
      this.#note.hidden = false;
    } else {
      const canvas = this.#canvas.transferControlToOffscreen();
      this.#world.server.post({kind: "pane", pane: this.#world.feed.pane, canvas}, [canvas as unknown as Transferable]);
    }
    this.#refresh();
  }

  close(): void {
    this.#gestures.close();
    this.#ends.forEach((end) => end());
    void this.#population?.then((population) => population.close());
    this.#world.server.post({kind: "close_pane", pane: this.#world.feed.pane});
    this.element.remove();
  }

  // ---- messages of the worker, changes of the world, the size ----

  #take(message: FromWorker): void {
    this.tiles.take(message);
    this.#picker.take(message);
    if (
      message.kind === "camera" && message.pane === this.#world.feed.pane && this.#world.selection.follow &&
      !this.#gestures.is_panning) {
      this.view.followed(message.camera);
    }
  }

  #refresh(): void {
    const {snapshot, feed: {drawing}, shown, island} = this.#world;
    if (snapshot !== null) {
      this.#take_size_of_island(snapshot.width_px, snapshot.height_px);
    }
    this.view.follow_selection();
    const alive = snapshot === null ?
      "" :
      pane_texts.alive(snapshot.generation, snapshot.live?.alive_count ?? snapshot.counts.organisms);
    set_attribute(
      this.#canvas, "aria-label", shown === "" ? pane_texts.no_world : pane_texts.island(island, shown, alive));
    this.#canvas.hidden = !this.#world.has_bodies;
    if (!this.#world.has_bodies) {
      this.#population ??= this.#load_population();
    }
    void this.#population?.then((population) => population.refresh());
    this.#legend.refresh(this.#world, this.tiles.is_on);
    this.tiles.refresh(this.view.size, this.view.island);
    this.#refresh_hint(drawing);
  }

  async #load_population(): Promise<PopulationView> {
    const {PopulationView: Loaded} = await import("../panels/loaded_later"), population = new Loaded(this.#world);
    this.element.append(population.element);
    return population;
  }

  #take_size_of_island(width: number, height: number): void {
    const before = this.view.island;
    if (before?.width === width && before.height === height) {
      return;
    }
    this.view.island = {width, height};
    if (before !== null) {
      this.view.set(null);
    }
    this.#options.on_view?.(this.view, "known");
  }

  #tiles_changed(had_focus: boolean): void {
    const {is_on} = this.tiles;
    this.view.shows_all = is_on;
    this.#canvas.inert = is_on;
    this.#refresh();
    if (!is_on && had_focus) {
      this.#canvas.focus({preventScroll: true});
    }
  }

  #resized(size: Size, pixel_ratio: number): void {
    this.view.size = size;
    this.#world.server.post({kind: "resize", pane: this.#world.feed.pane, ...size, pixel_ratio});
    this.#refresh();
  }

  // ---- the tool and its hint ----

  #tool_changed(): void {
    this.#canvas.dataset.tool = this.tool.tool;
    this.#send_pointer();
    this.#refresh();
    this.#options.on_tool?.();
  }

  /** Shows at the pointer what a click with a tool would do. The organism at the pointer has a label. */
  #refresh_hint(drawing: Drawing|null): void {
    const at = this.#pointer, there = drawing?.pointed_at ?? null, {tool} = this.tool;
    set_attribute(this.#canvas, "data-points", there?.organism != null && tool === "select" ? "" : null);
    const text = at === null || !this.#gestures.is_idle || there === null || tool === "select" ?
      "" :
      this.tool.problem() || this.tool.hint(there);
    this.#hint.hidden = text === "";
    set_text(this.#hint, text);
    if (text !== "") {
      const {width, height} = this.view.size;
      const right = Math.min(at!.x + hint_offset, width - this.#hint.offsetWidth - hint_margin);
      const bottom = Math.min(at!.y + hint_offset, height - this.#hint.offsetHeight - hint_margin);
      this.#hint.style.transform = `translate(${Math.max(right, hint_margin)}px, ${Math.max(bottom, hint_margin)}px)`;
    }
  }

  // ---- the pointer and the key 0 ----

  #target(): GestureTarget {
    return {
      pressed: (at) => {
        this.#pick = this.#picker.what_is_at(at);
        this.#refresh_hint(this.#world.feed.drawing);
      },
      clicked: (at) => void this.#click(at, this.#pick!),
      hovered: (at) => {
        this.#pointer = at;
        this.#send_pointer();
        this.#refresh_hint(this.#world.feed.drawing);
      },
      panned: (by) => this.view.pan(by),
      zoomed: (at, factor) => this.view.zoom_at(at, factor),
      is_on_minimap: (at) => this.view.is_on_minimap(at),
      minimap_dragged: (at) => this.view.look_at_minimap(at),
    };
  }

  #send_pointer(): void {
    const at = this.#pointer, tool: Tool = this.tool.tool;
    const key = `${at?.x} ${at?.y} ${tool}`;
    if (key !== this.#sent_pointer) {
      this.#sent_pointer = key;
      this.#world.server.post({kind: "pointer", pane: this.#world.feed.pane, at, tool});
    }
  }

  /** The organism that was under the pointer when it was pressed is meant, even if it has moved on since. */
  async #click(at: Point, pick: Promise<Picked>): Promise<void> {
    const now_ms = performance.now(), last = this.#last_click;
    this.#last_click = {at, ms: now_ms, selected: this.#world.selection.id};
    if (
      this.tool.tool === "select" && last !== null && now_ms - last.ms < double_click_ms &&
      Math.hypot(at.x - last.at.x, at.y - last.at.y) < double_click_pixels) {
      this.#last_click = null;
      this.view.fit();
      await pick; // the first click has selected by now what is there, and a double click selects nothing
      this.#world.selection.select(last.selected);
      return;
    }
    const picked = await pick;
    if (this.tool.tool === "select") {
      this.#world.selection.select(picked.organism);
      if (picked.organism !== null) {
        this.#options.on_select?.();
      }
    } else if (picked.x_px >= 0) { // it is on the island
      const places = this.tool.tool !== "remove", problem = await this.tool.use(picked);
      if (problem !== "") {
        const holds = (): boolean => this.tool.problem() === problem;
        this.#options.notify(
          problem, holds() ? holds : undefined, undefined, true); // otherwise the server has refused it
      } else if (places) {
        this.#options.on_placed?.();
      }
    }
  }

  #key_down(event: KeyboardEvent): void {
    if (event.key === "0" && !event.ctrlKey && !event.altKey && !event.metaKey) {
      this.view.fit();
      event.preventDefault();
    }
  }
}
