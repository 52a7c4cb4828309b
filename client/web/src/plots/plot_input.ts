// PlotInput: mouse, fingers and keyboard on the area of a plot: they move the cursor, and zoom and move the x axis.
import {width_of_area, x_at, x_near} from "./plot_frame";
import type {Frame} from "./plot_frame";
import type {LinkedX} from "./linked_x";
import {nearest} from "./plot_layout";
import type {Numbers} from "./plot_layout";
import type {Range} from "../widgets/visible_range";
import type {PlotView} from "./plot_content";
import type {PlotCursor} from "./plot_cursor";
import {wheel_notches} from "../widgets/wheel";

const zoom_of_one_notch = 1.25;
const drag_pixels = 5; // a pointer that moves less is a click
const double_click_ms = 300;
const fast_step = 10; // numbers, with Shift

interface Point {
  x: number;
  y: number;
}

/** What the input acts on. */
export interface PlotTarget {
  readonly area: HTMLElement;
  readonly cursor: PlotCursor;
  readonly link: LinkedX;
  frame(): Frame|null; // null: nothing is drawn
  view(): PlotView;
  draw_cursor(): void;
  place_note(): void;
  choose?: (x: number) => void; // the user chose these numbers
}

export class PlotInput {
  readonly #target: PlotTarget;
  #pointers = new Map<number, Point>();
  #drag: {from: number; at: number; x: Range; pan: boolean; moved: boolean; cursor: number | null}|null = null;
  #pinch: {x: Range; middle: number; distance: number}|null = null;
  #click_timer = 0;

  constructor(target: PlotTarget) {
    this.#target = target;
    const {area} = target;
    area.addEventListener("pointerdown", (event) => this.#pointer_down(event));
    area.addEventListener("pointermove", (event) => this.#pointer_move(event));
    area.addEventListener("pointerup", (event) => this.#pointer_up(event));
    area.addEventListener("pointercancel", (event) => this.#forget_pointer(event));
    area.addEventListener("pointerleave", (event) => {
      if (event.pointerType === "mouse" && this.#drag === null) {
        this.#set_cursor(null);
      }
    });
    area.addEventListener("dblclick", () => {
      clearTimeout(this.#click_timer);
      target.link.fit();
    });
    area.addEventListener("wheel", (event) => this.#wheel(event), {passive: false});
    area.addEventListener("keydown", (event) => this.#key_down(event));
    area.addEventListener("blur", () => this.#set_cursor(null));
  }

  close(): void {
    clearTimeout(this.#click_timer);
  }

  /** The columns of pixels between which the user drags, to zoom; null: none. */
  get selection(): [number, number]|null {
    const drag = this.#drag;
    return drag === null || !drag.moved || drag.pan ? null :
                                                      [Math.min(drag.from, drag.at), Math.max(drag.from, drag.at)];
  }

  #set_cursor(x: number|null): void {
    const {cursor} = this.#target;
    if (x !== cursor.x) {
      cursor.x = x;
      this.#target.draw_cursor();
    } else if (x !== null) {
      this.#target.place_note();
    }
  }

  /** The x of the numbers that are nearest to a column of pixels. */
  #x_near(frame: Frame, pixels: number): number|null {
    return x_near(frame, this.#target.view().content.series, pixels);
  }

  // ---- pointers ----

  #place_of(event: MouseEvent): Point {
    const box = this.#target.area.getBoundingClientRect();
    this.#target.cursor.pointer_y = event.clientY;
    return {x: event.clientX - box.left, y: event.clientY - box.top};
  }

  #pointer_down(event: PointerEvent): void {
    const frame = this.#target.frame();
    if (frame === null || event.button !== 0) {
      return;
    }
    const place = this.#place_of(event);
    const {axes} = this.#target.view();
    this.#pointers.set(event.pointerId, place);
    this.#target.area.setPointerCapture(event.pointerId);
    const [first, second] = [...this.#pointers.values()];
    if (first !== undefined && second !== undefined) {
      this.#drag = null;
      this.#pinch = axes ? {x: frame.x, ...pinched(first, second)} : null;
      return;
    }
    this.#drag = {
      from: place.x,
      at: place.x,
      x: frame.x,
      pan: event.shiftKey || !axes,
      moved: false,
      cursor: this.#target.cursor.x
    };
    if (event.pointerType !== "mouse") {
      this.#set_cursor(this.#x_near(frame, place.x));
    }
  }

  #pointer_move(event: PointerEvent): void {
    const frame = this.#target.frame();
    if (frame === null) {
      return;
    }
    const place = this.#place_of(event);
    if (this.#pointers.has(event.pointerId)) {
      this.#pointers.set(event.pointerId, place);
    }
    if (this.#pinch !== null) {
      this.#move_pinch(frame, this.#pinch);
    } else if (this.#drag === null || !this.#move_drag(event, frame, place)) {
      this.#set_cursor(this.#x_near(frame, place.x));
    }
  }

  #move_pinch(frame: Frame, {x, middle, distance}: {x: Range; middle: number; distance: number}): void {
    const [first, second] = [...this.#pointers.values()];
    if (first !== undefined && second !== undefined) {
      const width = width_of_area(frame), now = pinched(first, second);
      const share = Math.min(Math.max((middle - frame.area.left) / width, 0), 1);
      this.#target.link.zoom(
        x, share, now.distance / distance, ({min, max}) => ((middle - now.middle) / width) * (max - min));
    }
  }

  /** Returns whether the drag chooses or moves a part of the axis; false: it only moves the cursor. */
  #move_drag(event: PointerEvent, frame: Frame, place: Point): boolean {
    const drag = this.#drag!;
    drag.at = Math.min(Math.max(place.x, frame.area.left), frame.area.right);
    drag.moved = drag.moved || Math.abs(place.x - drag.from) > drag_pixels;
    if (!drag.moved || event.pointerType !== "mouse" || !this.#target.view().axes) {
      return false;
    }
    if (drag.pan) {
      const by = ((drag.from - place.x) / width_of_area(frame)) * (drag.x.max - drag.x.min);
      this.#target.link.move(drag.x, by);
    }
    this.#target.cursor.x = this.#x_near(frame, place.x);
    this.#target.draw_cursor();
    return true;
  }

  #pointer_up(event: PointerEvent): void {
    const drag = this.#drag, frame = this.#target.frame();
    const was_pinch = this.#pinch !== null;
    this.#forget_pointer(event);
    if (drag === null || frame === null || was_pinch) {
      return;
    }
    if (!drag.moved) {
      this.#click(event, frame, drag.cursor);
    } else if (event.pointerType === "mouse" && !drag.pan && this.#target.view().axes) {
      const a = x_at(frame, drag.from), b = x_at(frame, drag.at);
      this.#target.link.zoom({min: Math.min(a, b), max: Math.max(a, b)}, 0.5, 1);
    }
    this.#target.draw_cursor();
  }

  #forget_pointer(event: PointerEvent): void {
    this.#pointers.delete(event.pointerId);
    if (this.#pointers.size < 2) {
      this.#pinch = null;
    }
    this.#drag = null;
  }

  /** before: the cursor before the pointer went down. A finger reads the numbers first; a second tap on them chooses
   *  them. */
  #click(event: PointerEvent, frame: Frame, before: number|null): void {
    const x = this.#x_near(frame, this.#place_of(event).x);
    const {choose, link} = this.#target;
    if (x === null || choose === undefined || (event.pointerType !== "mouse" && before !== x)) {
      return;
    }
    clearTimeout(this.#click_timer);
    if (link.is_zoomed) { // a double click shows the whole axis
      this.#click_timer = window.setTimeout(() => choose(x), double_click_ms);
    } else {
      choose(x);
    }
  }

  #wheel(event: WheelEvent): void {
    const frame = this.#target.frame(), {link} = this.#target;
    const notches = wheel_notches(event);
    if (frame === null || !this.#target.view().axes || notches === 0 || (notches < 0 && !link.is_zoomed)) {
      return; // the page scrolls
    }
    event.preventDefault();
    const share = (this.#place_of(event).x - frame.area.left) / width_of_area(frame);
    link.zoom(frame.x, Math.min(Math.max(share, 0), 1), zoom_of_one_notch ** notches);
  }

  // ---- keys ----

  #key_down(event: KeyboardEvent): void {
    const frame = this.#target.frame();
    if (
      frame === null || event.ctrlKey || event.altKey || event.metaKey ||
      !this.#key(event.key, event.shiftKey, frame)) {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  }

  /** Returns whether the plot uses this key. */
  #key(key: string, fast: boolean, frame: Frame): boolean {
    const {cursor, link} = this.#target, {axes} = this.#target.view();
    const step = fast ? fast_step : 1;
    switch (key) {
      case "ArrowLeft":
        return this.#step(-step, frame);
      case "ArrowRight":
        return this.#step(step, frame);
      case "Home":
        return this.#step(-Infinity, frame);
      case "End":
        return this.#step(Infinity, frame);
      case "Enter":
        if (cursor.x !== null) {
          this.#target.choose?.(cursor.x);
        }
        return cursor.x !== null;
      case "Escape": {
        const had_cursor = cursor.x !== null;
        this.#set_cursor(null);
        return had_cursor;
      }
      case "+":
      case "=":
      case "-":
        if (axes) {
          const share = cursor.x === null ? 0.5 : (cursor.x - frame.x.min) / (frame.x.max - frame.x.min);
          link.zoom(frame.x, share, key === "-" ? 1 / zoom_of_one_notch : zoom_of_one_notch);
        }
        return axes;
      case "0":
        link.fit();
        return true;
      default:
        return false;
    }
  }

  /** Moves the cursor by this many numbers of the longest series, and the visible part with it. */
  #step(by: number, frame: Frame): boolean {
    const {cursor, link, area} = this.#target;
    const x = this.#target.view().content.series.reduce<Numbers>(
      (longest, series) => (series.x.length > longest.length ? series.x : longest), []);
    if (x.length === 0) {
      return false;
    }
    const now = cursor.x === null ? (by < 0 ? x.length : -1) : nearest(x, cursor.x);
    const next = x[Math.min(Math.max(now + by, 0), x.length - 1)]!;
    const box = area.getBoundingClientRect();
    cursor.pointer_y = (box.top + box.bottom) / 2;
    cursor.x = next;
    if (next < frame.x.min || next > frame.x.max) {
      link.move(frame.x, next < frame.x.min ? next - frame.x.min : next - frame.x.max);
    } else {
      this.#target.draw_cursor();
    }
    return true;
  }
}

function pinched(first: Point, second: Point): {middle: number; distance: number} {
  return {middle: (first.x + second.x) / 2, distance: Math.max(Math.abs(first.x - second.x), 10)};
}
