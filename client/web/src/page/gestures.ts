// Gestures: what a user does with pointers, the wheel and the arrow keys on a canvas: pan, zoom, pinch, hover, click,
// hold arrow keys.
import type {Point} from "../render/camera";
import {wheel_notches} from "../widgets/wheel";

/** What the gestures act on. Points are in CSS pixels of the canvas. */
export interface GestureTarget {
  pressed(at: Point): void;
  clicked(at: Point): void;
  /** at: of a mouse or pen over the canvas; null: it has left, or drags. */
  hovered(at: Point|null): void;
  panned(by: Point): void;
  zoomed(at: Point, factor: number): void;
  is_on_minimap(at: Point): boolean;
  minimap_dragged(at: Point): void;
}

const click_pixels_max = {
  mouse: 4,
  pen: 8,
  touch: 10
}; // a larger movement is a drag
const wheel_zoom_factor = 1.2; // per notch
const pinch_notches = 5; // a pinch on a touchpad comes as small steps with ctrlKey
const pan_pixels_per_s = 700; // by the arrow keys
const frame_min_ms = 8, frame_max_ms = 100;
const arrows: {readonly [key: string]: Point} = {
  ArrowLeft: {x: 1, y: 0},
  ArrowRight: {x: -1, y: 0},
  ArrowUp: {x: 0, y: 1},
  ArrowDown: {x: 0, y: -1},
};

export class Gestures {
  /** What the pressed pointers do: nothing yet, move the view, move the minimap's frame. */
  #gesture: "press"|"pan"|"minimap"|"none" = "none";
  readonly #canvas: HTMLElement;
  readonly #target: GestureTarget;
  readonly #pressed = new Map<number, Point>(); // by pointerId
  #pressed_at: Point = {x: 0, y: 0};
  readonly #held = new Set<string>(); // arrow keys
  readonly #released = new Set<string>(); // since the last frame
  #held_ms = 0;
  #frame = 0;

  constructor(canvas: HTMLElement, target: GestureTarget) {
    this.#canvas = canvas;
    this.#target = target;
    canvas.addEventListener("pointerdown", (event) => this.#press(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    canvas.addEventListener("pointerup", (event) => this.#release(event));
    canvas.addEventListener("pointercancel", (event) => this.#end(event));
    canvas.addEventListener("pointerleave", () => target.hovered(null));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => this.#wheel(event), {passive: false});
    canvas.addEventListener("keydown", (event) => this.#key_down(event));
    canvas.addEventListener("keyup", (event) => this.#released.add(event.key));
    canvas.addEventListener("blur", () => this.#held.clear());
  }

  /** Whether no pointer is pressed. */
  get is_idle(): boolean {
    return this.#gesture === "none";
  }

  get is_panning(): boolean {
    return this.#gesture === "pan";
  }

  close(): void {
    cancelAnimationFrame(this.#frame);
  }

  /** The place of an event. The origin is measured each time: the page may have scrolled. */
  #place_of(event: MouseEvent): Point {
    const {left, top} = this.#canvas.getBoundingClientRect();
    return {x: event.clientX - left, y: event.clientY - top};
  }

  #press(event: PointerEvent): void {
    if (event.pointerType === "mouse" && event.button > 1) {
      return;
    }
    const at = this.#place_of(event);
    this.#canvas.setPointerCapture(event.pointerId);
    this.#pressed.set(event.pointerId, at);
    if (this.#pressed.size > 1) { // a second finger: pinch
      this.#gesture = "pan";
    } else if (this.#target.is_on_minimap(at)) {
      this.#gesture = "minimap";
      this.#target.minimap_dragged(at);
    } else {
      this.#gesture = "press";
      this.#pressed_at = at;
      this.#target.pressed(at);
    }
  }

  #move(event: PointerEvent): void {
    const at = this.#place_of(event), before = this.#pressed.get(event.pointerId);
    if (before === undefined) {
      if (event.pointerType !== "touch") {
        this.#target.hovered(at);
      }
      return;
    }
    if (this.#gesture === "minimap") {
      this.#pressed.set(event.pointerId, at);
      this.#target.minimap_dragged(at);
      return;
    }
    if (this.#gesture === "press") {
      const from = this.#pressed_at;
      const limit = click_pixels_max[event.pointerType as keyof typeof click_pixels_max] ?? click_pixels_max.mouse;
      if (Math.hypot(at.x - from.x, at.y - from.y) < limit) {
        return; // a small movement during a click is not a drag
      }
      this.#gesture = "pan";
      this.#canvas.dataset.dragging = "";
      this.#target.hovered(null); // nothing is pointed at during a drag
    }
    const other = [...this.#pressed].find(([id]) => id !== event.pointerId)?.[1]; // it rests during this event
    this.#pressed.set(event.pointerId, at);
    if (other === undefined) {
      this.#target.panned({x: at.x - before.x, y: at.y - before.y});
    } else {
      const factor =
        Math.hypot(at.x - other.x, at.y - other.y) / Math.max(Math.hypot(before.x - other.x, before.y - other.y), 1);
      this.#target.zoomed({x: (before.x + other.x) / 2, y: (before.y + other.y) / 2}, factor);
      this.#target.panned({x: (at.x - before.x) / 2, y: (at.y - before.y) / 2});
    }
  }

  #release(event: PointerEvent): void {
    const was_click = this.#gesture === "press" && this.#pressed.size === 1, at = this.#place_of(event);
    this.#end(event);
    if (event.pointerType !== "touch") {
      this.#target.hovered(at);
    }
    if (was_click) {
      this.#target.clicked(at);
    }
  }

  #end(event: PointerEvent): void {
    this.#pressed.delete(event.pointerId);
    if (this.#pressed.size === 0) {
      this.#gesture = "none";
      delete this.#canvas.dataset.dragging;
    }
  }

  #wheel(event: WheelEvent): void {
    event.preventDefault();
    const notches = wheel_notches(event) * (event.ctrlKey ? pinch_notches : 1);
    this.#target.zoomed(this.#place_of(event), wheel_zoom_factor ** notches);
  }

  #key_down(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey || !(event.key in arrows)) {
      return;
    }
    this.#held.add(event.key);
    this.#released.delete(event.key);
    if (this.#frame === 0) {
      this.#held_ms = performance.now();
      this.#frame = requestAnimationFrame((now_ms) => this.#move_by_keys(now_ms));
    }
    event.preventDefault();
  }

  /** Moves the view as long as arrow keys are held. A short press moves it by one frame at least. */
  #move_by_keys(now_ms: number): void {
    const passed_ms = Math.min(Math.max(now_ms - this.#held_ms, frame_min_ms), frame_max_ms);
    const pixels = (pan_pixels_per_s * passed_ms) / 1000;
    this.#held_ms = now_ms;
    for (const key of this.#held) {
      this.#target.panned({x: pixels * arrows[key]!.x, y: pixels * arrows[key]!.y});
    }
    this.#released.forEach((key) => this.#held.delete(key));
    this.#released.clear();
    this.#frame = this.#held.size === 0 ? 0 : requestAnimationFrame((next_ms) => this.#move_by_keys(next_ms));
  }
}
