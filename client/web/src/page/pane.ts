// Pane: the canvas of one shown world, its camera and its pointer: pan, zoom, select, hover, follow, place and remove.
//
// The pane sends "pane", "close_pane", "resize", "camera", "pointer" and "pick" to the worker, which draws. ViewedWorld sends
// "watch", "look", "select" and "population".
import type {Camera, Drawing, FromWorker, Message, RequestKind, ToWorker, Tool} from "../core/messages";
import {contains, fitted, is_whole_island_visible, minimap_place, panned, Point, Size, zoomed} from "../render/camera";
import {set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {IslandLegend} from "./island_legend";
import {with_separators} from "../texts/numbers";
import type {ViewedWorld} from "../world/world";

/** The worker as the pane sees it. */
export interface WorkerLink {
  post(message: ToWorker, transfer?: Transferable[]): void;
  /** Calls `listener` for each message. Returns a function that ends it. */
  on_message(listener: (message: FromWorker) => void): () => void;
}

/** The organism that the tool "organism" places: its genes, and its name: "a copy of organism 12". */
export interface PlacedModel {
  name: string;
  genes: number[];
}

export interface PaneOptions {
  world: ViewedWorld;
  worker: WorkerLink;
  notify(text: string): void;
  /** Called when the user presses or focuses the pane. */
  on_focus?(): void;
  /** Called when the user has selected an organism in the pane. */
  on_select?(): void;
  /** Called after the tool was changed, by set_tool() or by the pane. */
  on_tool?(): void;
}

type Picked = Extract<FromWorker, {kind: "picked"}>;

const click_pixels_max = {
  mouse: 4,
  pen: 8,
  touch: 10
}; // a larger movement is a drag
const double_click_ms = 350;
const wheel_zoom_factor = 1.2; // per notch of 100 pixels
const pan_pixels_per_s = 700; // by the arrow keys
const pick_radius = 12;
const arrows: {readonly [key: string]: Point} = {
  ArrowLeft: {x: 1, y: 0},
  ArrowRight: {x: -1, y: 0},
  ArrowUp: {x: 0, y: 1},
  ArrowDown: {x: 0, y: -1},
};

/** What the pressed pointers do: nothing yet, move the view, move the minimap's frame. */
type Gesture = "press"|"pan"|"minimap"|"none";

export class Pane {
  readonly element: HTMLElement; // fills its container
  /** What is shown; null: the whole island. */
  camera: Camera|null = null;
  tool: Tool = "select";
  model: PlacedModel|null = null;

  readonly #canvas: HTMLCanvasElement;
  readonly #legend = new IslandLegend();
  readonly #hint = h("div", {class: "pane-hint", "aria-hidden": "true", hidden: true});
  readonly #note = h("p", {class: "pane-note", role: "status", hidden: true});
  readonly #world: ViewedWorld;
  readonly #worker: WorkerLink;
  readonly #observer: ResizeObserver;
  readonly #ends: (() => void)[] = [];
  #size: Size = {width: 1, height: 1};
  #island: Size|null = null;
  #pressed = new Map<number, Point>(); // by pointerId
  #pressed_at: Point|null = null;
  #gesture: Gesture = "none";
  #pick: Promise<Picked|null>|null = null; // what was at the pressed point
  #picks = new Map<number, (picked: Picked|null) => void>();
  #next_pick = 1;
  #last_click: {at: Point; ms: number; selected: number | null}|null = null;
  #pointer: Point|null = null; // of a mouse or pen over the canvas
  #sent_pointer = "";
  #held = new Set<string>(); // arrow keys
  #held_ms = 0;
  #frame = 0;

  constructor(readonly options: PaneOptions) {
    this.#world = options.world;
    this.#worker = options.worker;
    this.#canvas =
      h("canvas", {class: "pane-canvas", tabindex: 0, role: "application", "aria-roledescription": "island"});
    this.element =
      h("div", {class: "pane"}, this.#canvas, this.#legend.element, this.#hint, this.#note,
        h("div", {class: "pane-focus"}));
    this.#listen();
    this.#observer = new ResizeObserver((entries) => this.#resized(entries[entries.length - 1]!));
    try {
      this.#observer.observe(this.#canvas, {box: "device-pixel-content-box"});
    } catch {
      this.#observer.observe(this.#canvas); // this browser does not know the size in device pixels
    }
    this.#ends.push(
      this.#worker.on_message((message) => this.#take(message)), this.#world.changes.listen(() => this.#refresh()));
    if (typeof this.#canvas.transferControlToOffscreen === "function") {
      const offscreen = this.#canvas.transferControlToOffscreen();
      this.#worker.post(
        {kind: "pane", pane: this.#world.pane, canvas: offscreen}, [offscreen as unknown as Transferable]);
    } else {
      this.#show_note(
        "This browser cannot draw the island, because it has no OffscreenCanvas. Use a current version of Chrome, Edge, Firefox or Safari.");
    }
    this.#refresh();
  }

  // ---- the tool ----

  set_tool(tool: Tool): void {
    const {info: organism, id: selected} = this.#world.selection;
    if (tool === "organism" && organism !== null && selected !== null) {
      this.model = {name: `a copy of organism ${selected}`, genes: [...(organism.genes ?? [])]};
    }
    this.tool = tool;
    this.#canvas.dataset.tool = tool;
    this.#send_pointer();
    this.#refresh();
    this.options.on_tool?.();
  }

  /** Chooses the tool "organism" with these genes. */
  place_copies_of(model: PlacedModel): void {
    this.model = model;
    this.tool = "organism";
    this.#canvas.dataset.tool = this.tool;
    this.#send_pointer();
    this.options.on_tool?.();
  }

  /** Why the tool cannot act in this world, as a sentence; empty if it can. */
  tool_problem(tool: Tool): string {
    const world = this.#world;
    if (tool === "select") {
      return "";
    }
    if (!world.server.features.has("place")) {
      return "This server cannot place or remove anything; a newer version of evod can.";
    }
    if (!world.shown) {
      return "No world is open.";
    }
    if (world.is_replay) {
      return "A replay cannot be changed; fork it, and change the fork.";
    }
    const why = world.server.why_not(tool === "remove" ? "remove" : "place", world.shown);
    if (why !== "") {
      return why;
    }
    return tool === "organism" && this.model === null && world.selection.info === null ?
      "Select an organism to place copies of it." :
      "";
  }

  // ---- the camera ----

  /** Shows the whole island. */
  fit(): void {
    this.#world.selection.set_follow(false);
    this.#set_camera(null);
  }

  /** Multiplies the zoom; the middle stays. */
  zoom_by(factor: number): void {
    this.#zoom_at({x: this.#size.width / 2, y: this.#size.height / 2}, factor);
  }

  /** Moves the view by CSS pixels. */
  pan_by(x: number, y: number): void {
    this.#pan({x: -x, y: -y});
  }

  close(): void {
    this.#observer.disconnect();
    cancelAnimationFrame(this.#frame);
    this.#ends.forEach((end) => end());
    this.#worker.post({kind: "close_pane", pane: this.#world.pane});
    this.element.remove();
  }

  /** The camera that is shown; null before the first snapshot. */
  #shown(): Camera|null {
    return this.camera ?? (this.#island === null ? null : fitted(this.#size, this.#island));
  }

  #set_camera(camera: Camera|null): void {
    this.camera = camera;
    this.#worker.post({kind: "camera", pane: this.#world.pane, camera});
  }

  /** Moves the drawn island by this many pixels. A view that the user moves follows no organism. */
  #pan(by: Point): void {
    const shown = this.#shown();
    if (shown !== null && (by.x !== 0 || by.y !== 0)) {
      if (this.#world.selection.follow) {
        this.#world.selection.set_follow(false);
      }
      this.#set_camera(panned(shown, this.#size, this.#island!, by));
    }
  }

  #zoom_at(at: Point, factor: number): void {
    const shown = this.#shown();
    if (shown !== null) {
      this.#set_camera(zoomed(shown, this.#size, this.#island!, at, factor));
    }
  }

  #look_at_minimap(at: Point): void {
    const shown = this.#shown();
    if (shown !== null) {
      const {screen, zoom} = minimap_place(this.#size, this.#island!);
      this.#world.selection.set_follow(false);
      this.#set_camera(panned(
        {...shown, x_px: (at.x - screen.left) / zoom, y_px: (at.y - screen.top) / zoom}, this.#size, this.#island!,
        {x: 0, y: 0}));
    }
  }

  #is_on_minimap(at: Point): boolean {
    const shown = this.#shown();
    return shown !== null && this.#world.look.minimap && !is_whole_island_visible(shown, this.#size, this.#island!) &&
      contains(minimap_place(this.#size, this.#island!).screen, at);
  }

  // ---- messages of the worker, changes of the world, the size ----

  #take(message: FromWorker): void {
    if (message.kind === "picked") {
      this.#picks.get(message.id)?.(message);
      this.#picks.delete(message.id);
    } else if (
      message.kind === "camera" && message.pane === this.#world.pane && this.#world.selection.follow &&
      this.#gesture !== "pan") {
      this.camera = message.camera;
    }
  }

  #refresh(): void {
    const {snapshot, feed: {drawing}, shown} = this.#world;
    if (
      snapshot !== null &&
      (this.#island === null || this.#island.width !== snapshot.width_px ||
       this.#island.height !== snapshot.height_px)) {
      const is_first = this.#island === null;
      this.#island = {width: snapshot.width_px, height: snapshot.height_px};
      if (!is_first) {
        this.#set_camera(null);
      }
    }
    const alive = snapshot === null ?
      "" :
      `, generation ${with_separators(snapshot.generation)}, ${
        with_separators(snapshot.live?.alive_count ?? snapshot.counts.organisms)} organisms alive`;
    set_attribute(
      this.#canvas, "aria-label",
      shown === "" ?
        "No world is shown" :
        `Island ${this.#world.island} of world ${shown}${alive}. Arrow keys move the view, 0 shows the whole island.`);
    this.#legend.refresh(this.#world);
    this.#refresh_hint(drawing);
    if (drawing?.renderer === "canvas2d") {
      this.#show_note(
        "This browser has no WebGL2: the island is drawn in less detail, and large populations as densities.");
    }
  }

  #show_note(text: string): void {
    set_text(this.#note, text);
    this.#note.hidden = false;
  }

  /** Shows at the pointer what a click with a tool would do. The organism at the pointer has a label. */
  #refresh_hint(drawing: Drawing|null): void {
    const at = this.#pointer;
    const there = drawing?.pointed_at ?? null;
    set_attribute(this.#canvas, "data-points", there?.organism != null && this.tool === "select" ? "" : null);
    const text = at === null || this.#gesture !== "none" || there === null || this.tool === "select" ?
      "" :
      this.tool_problem(this.tool) || this.#tool_hint(there);
    this.#hint.hidden = text === "";
    set_text(this.#hint, text);
    if (text !== "") {
      const right = Math.min(at!.x + 16, this.#size.width - this.#hint.offsetWidth - 4);
      const bottom = Math.min(at!.y + 16, this.#size.height - this.#hint.offsetHeight - 4);
      this.#hint.style.transform = `translate(${Math.max(right, 4)}px, ${Math.max(bottom, 4)}px)`;
    }
  }

  #tool_hint(there: {organism: number|null; food: number | null; poison: number | null}): string {
    switch (this.tool) {
      case "select":
        return "";
      case "food":
        return "Place food";
      case "poison":
        return "Place poison";
      case "organism":
        return `Place ${this.model?.name ?? "an organism"}`;
      case "remove":
        return there.organism !== null ? `Remove organism ${there.organism}` :
          there.food !== null   ? "Remove food" :
          there.poison !== null ? "Remove poison" :
                                  "Nothing to remove here";
    }
  }

  #resized(entry: ResizeObserverEntry): void {
    const {width, height} = entry.contentRect;
    if (width === 0 || height === 0) {
      return; // hidden
    }
    const device = entry.devicePixelContentBoxSize?.[0];
    const device_pixels =
      (exact: number|undefined, pixels: number): number => // the exact size is missing, or wrong in emulated devices
      exact !== undefined && Math.abs(exact - pixels * devicePixelRatio) < 1.5 ?
      exact :
      Math.max(Math.round(pixels * devicePixelRatio), 1);
    const device_width = device_pixels(device?.inlineSize, width);
    const device_height = device_pixels(device?.blockSize, height);
    const pixel_ratio = device_width / width;
    this.#size = {
      width,
      height: device_height / pixel_ratio
    }; // both are whole numbers of device pixels, so that nothing is blurred
    this.#worker.post({kind: "resize", pane: this.#world.pane, ...this.#size, pixel_ratio});
    this.#refresh();
  }

  // ---- the pointer ----

  #listen(): void {
    const canvas = this.#canvas;
    canvas.addEventListener("pointerdown", (event) => this.#press(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    canvas.addEventListener("pointerup", (event) => this.#release(event));
    canvas.addEventListener("pointercancel", (event) => this.#cancel(event));
    canvas.addEventListener("pointerleave", () => this.#hover(null));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => this.#wheel(event), {passive: false});
    canvas.addEventListener("keydown", (event) => this.#key_down(event));
    canvas.addEventListener("keyup", (event) => this.#held.delete(event.key));
    canvas.addEventListener("blur", () => this.#held.clear());
    canvas.addEventListener("focus", () => this.options.on_focus?.());
  }

  /** A pointer event in CSS pixels of the canvas. The origin is measured each time: the page may have scrolled. */
  #place_of(event: MouseEvent): Point {
    const {left, top} = this.#canvas.getBoundingClientRect();
    return {x: event.clientX - left, y: event.clientY - top};
  }

  #press(event: PointerEvent): void {
    this.options.on_focus?.();
    if (event.pointerType === "mouse" && event.button > 1) {
      return;
    }
    const at = this.#place_of(event);
    this.#canvas.setPointerCapture(event.pointerId);
    this.#pressed.set(event.pointerId, at);
    if (this.#pressed.size > 1) { // a second finger: pinch
      this.#gesture = "pan";
      this.#pressed_at = null;
    } else if (this.#is_on_minimap(at)) {
      this.#gesture = "minimap";
      this.#look_at_minimap(at);
    } else {
      this.#gesture = "press";
      this.#pressed_at = at;
      this.#pick = this.#what_is_at(at);
    }
    this.#refresh_hint(this.#world.feed.drawing);
  }

  #move(event: PointerEvent): void {
    const at = this.#place_of(event);
    const before = this.#pressed.get(event.pointerId);
    if (before === undefined) {
      if (event.pointerType !== "touch") {
        this.#hover(at);
      }
      return;
    }
    if (this.#gesture === "minimap") {
      this.#pressed.set(event.pointerId, at);
      this.#look_at_minimap(at);
      return;
    }
    if (this.#gesture === "press") {
      const from = this.#pressed_at!;
      const limit = click_pixels_max[event.pointerType as keyof typeof click_pixels_max] ?? click_pixels_max.mouse;
      if (Math.hypot(at.x - from.x, at.y - from.y) < limit) {
        return; // a small movement during a click is no drag
      }
      this.#gesture = "pan";
      this.#canvas.dataset.dragging = "";
      this.#hover(null); // nothing is pointed at during a drag
    }
    const others = [...this.#pressed].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
    this.#pressed.set(event.pointerId, at);
    if (others.length === 0) {
      this.#pan({x: at.x - before.x, y: at.y - before.y});
    } else { // the other fingers rest during this event
      const other = others[0]!;
      const factor =
        Math.hypot(at.x - other.x, at.y - other.y) / Math.max(Math.hypot(before.x - other.x, before.y - other.y), 1);
      this.#zoom_at({x: (before.x + other.x) / 2, y: (before.y + other.y) / 2}, factor);
      this.#pan({x: (at.x - before.x) / 2, y: (at.y - before.y) / 2});
    }
  }

  #release(event: PointerEvent): void {
    const was_click = this.#gesture === "press" && this.#pressed.size === 1;
    this.#cancel(event);
    if (event.pointerType !== "touch") {
      this.#hover(this.#place_of(event));
    }
    if (was_click) {
      void this.#click(this.#place_of(event), this.#pick!);
    }
  }

  #cancel(event: PointerEvent): void {
    this.#pressed.delete(event.pointerId);
    if (this.#pressed.size === 0) {
      this.#gesture = "none";
      this.#pressed_at = null;
      delete this.#canvas.dataset.dragging;
    }
  }

  #hover(at: Point|null): void {
    this.#pointer = at;
    this.#send_pointer();
    this.#refresh_hint(this.#world.feed.drawing);
  }

  #send_pointer(): void {
    const at = this.#pointer;
    const key = `${at?.x} ${at?.y} ${this.tool}`;
    if (key !== this.#sent_pointer) {
      this.#sent_pointer = key;
      this.#worker.post({kind: "pointer", pane: this.#world.pane, at, tool: this.tool});
    }
  }

  #wheel(event: WheelEvent): void {
    event.preventDefault();
    const pixels = event.deltaY *
      (event.deltaMode === WheelEvent.DOM_DELTA_LINE   ? 33 :
         event.deltaMode === WheelEvent.DOM_DELTA_PAGE ? 400 :
                                                         1);
    const notches = Math.min(Math.max(-pixels / 100, -3), 3) *
      (event.ctrlKey ? 5 : 1); // a pinch on a touchpad comes as small steps with ctrlKey
    this.#zoom_at(this.#place_of(event), wheel_zoom_factor ** notches);
  }

  #what_is_at(at: Point): Promise<Picked|null> {
    const id = this.#world.pane * 1_000_000 + this.#next_pick++;
    return new Promise((resolve) => {
      this.#picks.set(id, resolve);
      this.#worker.post({kind: "pick", pane: this.#world.pane, id, x: at.x, y: at.y, radius: pick_radius});
    });
  }

  /** The organism that was under the pointer when it was pressed is meant, even if it has moved on since. */
  async #click(at: Point, pick: Promise<Picked|null>): Promise<void> {
    const now_ms = performance.now();
    const last = this.#last_click;
    this.#last_click = {at, ms: now_ms, selected: this.#world.selection.id};
    if (
      this.tool === "select" && last !== null && now_ms - last.ms < double_click_ms &&
      Math.hypot(at.x - last.at.x, at.y - last.at.y) < 20) {
      this.#last_click = null;
      this.fit();
      await pick; // the first click has selected by now what is there, and a double click selects nothing
      this.#world.selection.select(last.selected);
      return;
    }
    const picked = await pick;
    if (this.tool === "select") {
      const organism = picked?.organism ?? null;
      this.#world.selection.select(organism);
      if (organism !== null) {
        this.options.on_select?.();
      }
      return;
    }
    if (picked === null || picked.x_px < 0) {
      return; // beside the island
    }
    const problem = this.tool_problem(this.tool);
    if (problem !== "") {
      this.options.notify(problem);
      return;
    }
    await this.#use_tool(picked);
  }

  async #use_tool(picked: Picked): Promise<void> {
    const world = this.#world;
    const {snapshot} = world;
    if (snapshot === null) {
      return;
    }
    const where = {world: world.shown, island: world.island};
    const inside = (value: number, size: number, radius: number) => Math.min(Math.max(value, radius), size - radius);
    const place = (radius: number) =>
      ({x_px: inside(picked.x_px, snapshot.width_px, radius), y_px: inside(picked.y_px, snapshot.height_px, radius)});
    let kind = "place";
    let fields: Message;
    if (this.tool === "remove") {
      const what = picked.organism !== null ? {organisms: [picked.organism]} :
        picked.food !== null                ? {food: [picked.food]} :
        picked.poison !== null              ? {poison: [picked.poison]} :
                                              null;
      if (what === null) {
        this.options.notify("Nothing to remove here");
        return;
      }
      kind = "remove";
      fields = {...where, generation: picked.generation, ...what};
    } else if (this.tool === "organism") {
      fields = {...where, organisms: [{...place(10), genes: this.model?.genes ?? []}]};
    } else {
      fields = {
        ...where,
        items: [{...place(snapshot.item_radius_px), kind: this.tool === "food" ? "ITEM_KIND_FOOD" : "ITEM_KIND_POISON"}]
      };
    }
    try {
      await world.server.request(kind as RequestKind, fields);
    } catch (error) {
      this.options.notify(error instanceof Error ? error.message : String(error));
    }
  }

  // ---- keys ----

  #key_down(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey) {
      return;
    }
    if (event.key in arrows) {
      this.#held.add(event.key);
      if (this.#frame === 0) {
        this.#held_ms = performance.now();
        this.#frame = requestAnimationFrame((now_ms) => this.#move_by_keys(now_ms));
      }
    } else if (event.key === "0") {
      this.fit();
    } else {
      return;
    }
    event.preventDefault();
  }

  /** Moves the view as long as arrow keys are held. A short press moves it by one frame at least. */
  #move_by_keys(now_ms: number): void {
    const pixels = (pan_pixels_per_s * Math.min(Math.max(now_ms - this.#held_ms, 8), 100)) / 1000;
    this.#held_ms = now_ms;
    for (const key of this.#held) {
      this.#pan({x: pixels * arrows[key]!.x, y: pixels * arrows[key]!.y});
    }
    this.#frame = this.#held.size === 0 ? 0 : requestAnimationFrame((next_ms) => this.#move_by_keys(next_ms));
  }
}
