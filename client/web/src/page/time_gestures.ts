// TimeGestures: what a user does with pointers and the wheel on the time line: choose a moment, zoom around the
// pointer, move the line.
//
// A drag chooses moments; a drag on the labels above the line moves a line that is zoomed, and so do two fingers, which
// also zoom.
import {wheel_notches, wheel_unit_px} from "../widgets/wheel";

/** What the gestures act on. Positions are 0 to 1. */
export interface TimeTarget {
  is_zoomed(): boolean;
  chosen(part: number): void;
  /** null: the pointer has left. */
  hovered(part: number|null): void;
  zoomed(part: number, factor: number): void;
  panned(parts: number): void;
  /** No pointer is pressed any more. */
  released(): void;
}

const labels_px = 15; // their height
const touch_px = 8; // a larger movement of one finger is a drag
const wheel_zoom_factor = 1.25; // per notch

export class TimeGestures {
  #gesture: "none"|"touch"|"choose"|"pan"|"pinch" = "none";
  readonly #element: HTMLElement;
  readonly #target: TimeTarget;
  readonly #pressed = new Map<number, number>(); // by pointerId: clientX
  #pressed_x = 0;

  constructor(element: HTMLElement, target: TimeTarget) {
    this.#element = element;
    this.#target = target;
    element.addEventListener("pointerdown", (event) => this.#press(event));
    element.addEventListener("pointermove", (event) => this.#move(event));
    element.addEventListener("pointerup", (event) => this.#release(event, true));
    element.addEventListener("pointercancel", (event) => this.#release(event, false));
    element.addEventListener("pointerleave", () => target.hovered(null));
    element.addEventListener("wheel", (event) => this.#wheel(event), {passive: false});
  }

  /** Whether the user chooses a moment. */
  get is_choosing(): boolean {
    return this.#gesture === "choose";
  }

  #part_at(client_x: number): number {
    const {left, width} = this.#element.getBoundingClientRect();
    return Math.min(Math.max((client_x - left) / Math.max(width, 1), 0), 1);
  }

  #press(event: PointerEvent): void {
    if (event.pointerType === "mouse" && event.button !== 0) {
      return;
    }
    this.#element.setPointerCapture(event.pointerId);
    this.#pressed.set(event.pointerId, event.clientX);
    this.#pressed_x = event.clientX;
    const is_on_labels = event.clientY - this.#element.getBoundingClientRect().top < labels_px;
    if (this.#pressed.size > 1) {
      this.#gesture = "pinch";
    } else if (this.#target.is_zoomed() && is_on_labels) {
      this.#gesture = "pan";
    } else if (event.pointerType === "touch") {
      this.#gesture = "touch"; // a second finger may follow
    } else {
      this.#gesture = "choose";
      this.#target.chosen(this.#part_at(event.clientX));
    }
  }

  #move(event: PointerEvent): void {
    const before = this.#pressed.get(event.pointerId), at = event.clientX,
          {width} = this.#element.getBoundingClientRect();
    if (before === undefined) {
      if (event.pointerType !== "touch") {
        this.#target.hovered(this.#part_at(at));
      }
      return;
    }
    const other = [...this.#pressed].find(([id]) => id !== event.pointerId)?.[1];
    this.#pressed.set(event.pointerId, at);
    if (this.#gesture === "touch" && Math.abs(at - this.#pressed_x) > touch_px) {
      this.#gesture = "choose";
    }
    if (this.#gesture === "choose") {
      this.#target.chosen(this.#part_at(at));
    } else if (this.#gesture === "pan") {
      this.#target.panned((before - at) / Math.max(width, 1));
    } else if (this.#gesture === "pinch" && other !== undefined) {
      const factor = Math.max(Math.abs(at - other), 1) / Math.max(Math.abs(before - other), 1);
      this.#target.zoomed(this.#part_at((before + other) / 2), factor);
      this.#target.panned((before - at) / 2 / Math.max(width, 1));
    }
  }

  #release(event: PointerEvent, is_end: boolean): void {
    if (!this.#pressed.delete(event.pointerId)) {
      return;
    }
    if (this.#gesture === "touch" && is_end) { // a tap
      this.#gesture = "choose";
      this.#target.chosen(this.#part_at(event.clientX));
    }
    if (this.#pressed.size === 0) {
      this.#gesture = "none";
      this.#target.released();
    }
  }

  #wheel(event: WheelEvent): void {
    event.preventDefault();
    const {width} = this.#element.getBoundingClientRect();
    const sideways = event.shiftKey && event.deltaX === 0 ? event.deltaY : event.deltaX;
    if (Math.abs(sideways) > Math.abs(event.deltaY) || event.shiftKey) {
      this.#target.panned((sideways * wheel_unit_px(event)) / Math.max(width, 1));
      return;
    }
    this.#target.zoomed(this.#part_at(event.clientX), wheel_zoom_factor ** wheel_notches(event));
  }
}
