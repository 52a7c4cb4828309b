// TimeSlider: the line of the generations of a run: its knob shows the shown moment, and the user drags along the line
// or presses keys to show another one.
import {timeline_texts} from "../texts/timeline";
import {set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {type Moment, TimeScale} from "../world/time_scale";
import type {ViewedWorld} from "../world/world";
import type {Seeker} from "./seeker";
import {percent, TimeMarks} from "./time_marks";

const texts_max = 3; // of marks at the pointer
const mark_px = 4; // a mark at most so far from the pointer is described
const key_ticks = 60, page_generations = 10;
const steps: {[key: string]: number} = {
  ArrowLeft: -1,
  ArrowDown: -1,
  ArrowRight: 1,
  ArrowUp: 1
};

export class TimeSlider {
  readonly element: HTMLElement;
  readonly #fill = h("div", {class: "time-fill"});
  readonly #knob = h("div", {class: "time-knob"});
  readonly #bubble = h("div", {class: "time-bubble", hidden: true});
  readonly #marks: TimeMarks;
  readonly #world: ViewedWorld;
  readonly #seeker: Seeker;
  readonly #observer: ResizeObserver;
  #width_px = 0;
  #is_pressed = false;
  #dragged: number|null = null; // where the pointer is while it is pressed, and was until the last seek is answered
  #hovered: number|null = null;

  constructor(world: ViewedWorld, seeker: Seeker) {
    this.#world = world;
    this.#seeker = seeker;
    this.#marks = new TimeMarks(world, () => this.refresh());
    this.element =
      h("div", {
        class: "time-line",
        tabindex: 0,
        role: "slider",
        "aria-label": timeline_texts.slider,
        onpointerdown: (event: PointerEvent) => this.#press(event),
        onpointermove: (event: PointerEvent) => this.#move(event),
        onpointerup: () => this.#release(),
        onpointercancel: () => this.#release(),
        onpointerleave: () => this.#hover(null),
        onkeydown: (event: KeyboardEvent) => this.#key(event),
      },
        this.#marks.labels, h("div", {class: "time-bar"}, this.#fill), this.#marks.marks, this.#knob, this.#bubble);
    this.#observer = new ResizeObserver((entries) => {
      this.#width_px = entries[entries.length - 1]!.contentRect.width;
      this.refresh();
    });
    this.#observer.observe(this.element);
  }

  close(): void {
    this.#observer.disconnect();
    this.#marks.close();
  }

  /** No seek runs any more: the knob shows the shown moment again. */
  seek_ended(): void {
    if (!this.#is_pressed) {
      this.#dragged = null;
    }
    this.refresh();
  }

  refresh(): void {
    const world = this.#world, scale = this.#scale(), {snapshot} = world;
    if (!scale || !snapshot) {
      return;
    }
    const shown_part = world.is_replay ? scale.part_of(snapshot.generation, snapshot.tick) : 1;
    const part = this.#dragged ?? this.#place_of(scale, world.past.target) ?? shown_part;
    this.#knob.style.left = this.#fill.style.width = percent(part);
    const tick = world.is_replay ? timeline_texts.tick(snapshot.generation_tick) : timeline_texts.live;
    set_attribute(this.element, "aria-valuemin", String(scale.range.first_generation));
    set_attribute(this.element, "aria-valuemax", String(scale.range.last_generation));
    set_attribute(this.element, "aria-valuenow", String(snapshot.generation));
    set_attribute(this.element, "aria-valuetext", `${tick}, ${timeline_texts.generation(snapshot.generation)}`);
    this.#marks.refresh(scale, this.#width_px);
    this.#show_bubble(scale);
  }

  #scale(): TimeScale|null {
    const {range} = this.#world.past;
    return range && new TimeScale(range, (generation) => this.#world.past.ticks_of(generation));
  }

  /** The position of the moment that a seek leads to; null if the page does not know it. */
  #place_of(scale: TimeScale, target: Moment|null): number|null {
    if (target?.generation === undefined) {
      return null;
    }
    const ticks = this.#world.past.ticks_of(target.generation);
    return scale.part_of(target.generation, ticks && target.tick !== undefined ? ticks.first + target.tick : undefined);
  }

  /** Says at the pointer which moment a click shows, and what happened there. */
  #show_bubble(scale: TimeScale): void {
    const at = this.#is_pressed ? this.#dragged : this.#hovered;
    this.#bubble.hidden = at === null;
    if (at === null) {
      return;
    }
    const {generation, tick} = scale.moment_at(at, this.#width_px);
    const first = this.#world.past.ticks_of(generation)?.first,
          texts = this.#marks.texts_at(at, mark_px / Math.max(this.#width_px, 1));
    const place = timeline_texts.generation(generation) +
      (tick !== undefined && first !== undefined ? `, ${timeline_texts.tick(tick - first)}` : "");
    const further = texts.length - texts_max;
    const lines =
      [place, ...texts.slice(0, texts_max), ...(further > 0 ? [timeline_texts.further_marks(further)] : [])];
    set_text(this.#bubble, lines.join("\n"));
    const half = this.#bubble.offsetWidth / 2, right = Math.max(this.#width_px - half, half);
    this.#bubble.style.left = `${Math.min(Math.max(at * this.#width_px, half), right)}px`;
  }

  #part_at(event: PointerEvent): number {
    const {left, width} = this.element.getBoundingClientRect();
    return Math.min(Math.max((event.clientX - left) / Math.max(width, 1), 0), 1);
  }

  #press(event: PointerEvent): void {
    if (event.pointerType === "mouse" && event.button !== 0) {
      return;
    }
    this.element.setPointerCapture(event.pointerId);
    this.#is_pressed = true;
    this.#drag_to(this.#part_at(event));
  }

  #move(event: PointerEvent): void {
    if (this.#is_pressed) {
      this.#drag_to(this.#part_at(event));
    } else if (event.pointerType !== "touch") {
      this.#hover(this.#part_at(event));
    }
  }

  #drag_to(part: number): void {
    if (part === this.#dragged) {
      return;
    }
    this.#dragged = part;
    const scale = this.#scale();
    if (scale) {
      const {generation, tick} = scale.moment_at(part, this.#width_px);
      this.#seeker.go(tick === undefined ? {generation} : {tick});
    }
    this.refresh();
  }

  #release(): void {
    this.#is_pressed = false;
    this.#hovered = null;
    if (!this.#seeker.is_seeking) {
      this.#dragged = null;
    }
    this.refresh();
  }

  #hover(part: number|null): void {
    this.#hovered = part;
    const scale = this.#scale();
    if (scale) {
      this.#show_bubble(scale);
    }
  }

  #key(event: KeyboardEvent): void {
    const world = this.#world, seeker = this.#seeker, by = steps[event.key] ?? 0;
    if (event.ctrlKey || event.altKey || event.metaKey) {
      return;
    }
    if (by !== 0) {
      if (world.is_replay || by < 0) {
        void seeker.attempt(
          () => (event.shiftKey ? world.past.move_ticks(by * key_ticks) : world.past.move_generations(by)));
      }
    } else if (event.key === "PageUp" || event.key === "PageDown") {
      void seeker.attempt(
        () => world.past.move_generations(event.key === "PageUp" ? page_generations : -page_generations));
    } else if (event.key === "Home") {
      seeker.go_to_first();
    } else if (event.key === "End") {
      if (world.is_replay) {
        seeker.go({});
      }
    } else {
      return;
    }
    event.preventDefault();
  }
}
