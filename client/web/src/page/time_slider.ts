// TimeSlider: the line of the generations of a run, or of a part of them: its knob shows the shown moment, and the user
// drags along the line or presses keys to show another one.
import {timeline_texts as texts} from "../texts/timeline";
import {set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {type Moment, TimeScale, TimeZoom} from "../world/time_scale";
import type {ViewedWorld} from "../world/world";
import type {Seeker} from "./seeker";
import {TimeGestures} from "./time_gestures";
import {percent, TimeMarks} from "./time_marks";

const texts_max = 3; // of marks at the pointer
const mark_px = 5; // a mark at most so far from the pointer is described
const key_ticks = 60, page_generations = 10;
const key_zoom_factor = 2;
const steps: {[key: string]: number} = {
  ArrowLeft: -1,
  ArrowDown: -1,
  ArrowRight: 1,
  ArrowUp: 1
};
const zooms: {[key: string]: number} = {
  "+": key_zoom_factor,
  "=": key_zoom_factor,
  "-": 1 / key_zoom_factor,
  "_": 1 / key_zoom_factor
};

export class TimeSlider {
  readonly element: HTMLElement;
  readonly #fill = h("div", {class: "time-fill"});
  readonly #knob = h("div", {class: "time-knob"});
  readonly #bubble = h("div", {class: "time-bubble", hidden: true});
  readonly #marks: TimeMarks;
  readonly #zoom = new TimeZoom();
  readonly #gestures: TimeGestures;
  readonly #world: ViewedWorld;
  readonly #seeker: Seeker;
  readonly #observer: ResizeObserver;
  #width_px = 0;
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
        "aria-label": texts.slider,
        onkeydown: (event: KeyboardEvent) => this.#key(event),
        onfocus: () => this.refresh(),
        onblur: () => this.refresh(),
      },
        this.#marks.labels, h("div", {class: "time-bar"}, this.#fill), this.#marks.marks, this.#knob, this.#bubble);
    this.#gestures = new TimeGestures(this.element, {
      is_zoomed: () => this.is_zoomed,
      chosen: (part) => this.#drag_to(part),
      hovered: (part) => this.#hover(part),
      zoomed: (part, factor) => this.zoom(factor, part),
      panned: (parts) => this.#pan(parts),
      released: () => this.#release(),
    });
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

  /** Whether the line shows only a part of the run. */
  get is_zoomed(): boolean {
    return this.#zoom.is_on;
  }

  /** Multiplies the zoom. part: the position that stays; absent: that of the shown moment. */
  zoom(factor: number, part?: number): void {
    const {range} = this.#world.past, scale = this.#scale();
    if (range && scale) {
      this.#zoom.zoom(range, part ?? Math.min(Math.max(this.#shown_part(scale), 0), 1), factor);
      this.refresh();
    }
  }

  /** Shows the whole run. */
  show_all(): void {
    this.#zoom.show_all();
    this.refresh();
  }

  /** No seek runs any more: the knob shows the shown moment again. */
  seek_ended(): void {
    if (!this.#gestures.is_choosing) {
      this.#dragged = null;
    }
    this.refresh();
  }

  refresh(): void {
    const world = this.#world, scale = this.#scale(), {snapshot} = world;
    if (!scale || !snapshot) {
      return;
    }
    const part = this.#dragged ?? this.#shown_part(scale);
    this.#knob.style.left = percent(part);
    this.#knob.hidden = part < 0 || part > 1;
    this.#fill.style.width = percent(Math.min(Math.max(part, 0), 1));
    const tick = world.is_replay ? texts.tick(snapshot.generation_tick) : texts.live;
    this.#marks.refresh(scale, this.#width_px);
    const {from, to} = scale.shown, there = this.#marks.texts_of(snapshot.generation);
    const value = [
      `${tick}, ${texts.generation(snapshot.generation)}`, ...there,
      ...(this.is_zoomed ? [texts.zoomed(Math.floor(from), Math.ceil(to) - 1)] : [])
    ];
    set_attribute(this.element, "aria-valuemin", String(scale.range.first_generation));
    set_attribute(this.element, "aria-valuemax", String(scale.range.last_generation));
    set_attribute(this.element, "aria-valuenow", String(snapshot.generation));
    set_attribute(this.element, "aria-valuetext", value.join("; "));
    set_attribute(this.element, "data-zoomed", this.is_zoomed ? "" : null);
    this.#show_bubble(scale);
  }

  #scale(): TimeScale|null {
    const {range} = this.#world.past;
    return range &&
      new TimeScale(range, (generation) => this.#world.past.ticks_of(generation), this.#zoom.shown(range));
  }

  /** The position of the shown moment, or of that to which a seek leads. */
  #shown_part(scale: TimeScale): number {
    const world = this.#world, {snapshot} = world, {last_generation, last_tick} = scale.range;
    const shown = world.is_replay && snapshot ? scale.part_of(snapshot.generation, snapshot.tick) :
                                                scale.part_of(last_generation + 1, last_tick);
    return this.#place_of(scale, world.past.target) ?? shown;
  }

  /** The position of the moment that a seek leads to; null if the page does not know it. */
  #place_of(scale: TimeScale, target: Moment|null): number|null {
    if (target?.generation === undefined) {
      return null;
    }
    const ticks = this.#world.past.ticks_of(target.generation);
    return scale.part_of(target.generation, ticks && target.tick !== undefined ? ticks.first + target.tick : undefined);
  }

  /** Says at the pointer which moment a click shows, and what happened there; for keys, what happened at the knob. */
  #show_bubble(scale: TimeScale): void {
    const is_chosen = this.#gestures.is_choosing, has_focus = this.element.matches(":focus-visible");
    const pointed = is_chosen ? this.#dragged : this.#hovered,
          at = pointed ?? (has_focus ? this.#shown_part(scale) : -1);
    const near = mark_px / Math.max(this.#width_px, 1);
    const {generation, tick} = scale.moment_at(at, this.#width_px);
    const marks = pointed === null ? this.#marks.texts_of(generation) : this.#marks.texts_at(at, near);
    this.#bubble.hidden = at < 0 || at > 1 || (pointed === null && marks.length === 0);
    if (this.#bubble.hidden) {
      return;
    }
    const first = this.#world.past.ticks_of(generation)?.first;
    const place =
      texts.generation(generation) + (tick !== undefined && first !== undefined ? `, ${texts.tick(tick - first)}` : "");
    const further = marks.length - texts_max;
    const lines = [place, ...marks.slice(0, texts_max), ...(further > 0 ? [texts.further_marks(further)] : [])];
    set_text(this.#bubble, lines.join("\n"));
    const half = this.#bubble.offsetWidth / 2, right = Math.max(this.#width_px - half, half);
    this.#bubble.style.left = `${Math.min(Math.max(at * this.#width_px, half), right)}px`;
  }

  #drag_to(part: number): void {
    if (part === this.#dragged) {
      return;
    }
    this.#dragged = part;
    const scale = this.#scale();
    if (scale) {
      const {generation, tick} = scale.moment_at(part, this.#width_px);
      const first =
        this.#world.past.ticks_of(generation)?.first; // a tick alone may be the end of the generation before
      this.#seeker.go(tick === undefined || first === undefined ? {generation} : {generation, tick: tick - first});
    }
    this.refresh();
  }

  #release(): void {
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

  #pan(parts: number): void {
    const {range} = this.#world.past;
    if (range) {
      this.#zoom.pan(range, parts);
      this.refresh();
    }
  }

  /** Shows a generation by a key, and moves a zoomed line to it. */
  #go_to(generation: number): void {
    const {range} = this.#world.past;
    if (range) {
      this.#zoom.include(range, generation);
      this.#seeker.go({generation});
    }
  }

  #key(event: KeyboardEvent): void {
    if (event.altKey || event.metaKey || !this.#key_acts(event)) {
      return;
    }
    event.preventDefault();
  }

  /** Returns whether the key has a meaning here. */
  #key_acts({key, ctrlKey, shiftKey}: KeyboardEvent): boolean {
    const world = this.#world, by = steps[key] ?? 0, {range} = world.past, page = key === "PageUp" ? 1 : -1;
    if (ctrlKey) {
      const marked = by === 0 ? null : this.#marks.next_generation(world.snapshot?.generation ?? 1, by);
      if (marked !== null) {
        this.#go_to(marked);
      }
      return by !== 0;
    }
    if (by !== 0 && shiftKey) {
      if (world.is_replay || by < 0) {
        void this.#seeker.attempt(() => world.past.move_ticks(by * key_ticks));
      }
    } else if (by !== 0 || key === "PageUp" || key === "PageDown") {
      const from = world.past.target?.generation ?? world.snapshot?.generation, step = by || page * page_generations;
      if (range && from !== undefined && (world.is_replay || step < 0)) {
        this.#go_to(Math.min(Math.max(from + step, range.first_generation), range.last_generation));
      }
    } else if (zooms[key] !== undefined) {
      this.zoom(zooms[key]!);
    } else if (key === "0") {
      this.show_all();
    } else if (key === "Home") {
      this.#seeker.go_to_first();
    } else if (key !== "End") {
      return false;
    } else if (world.is_replay) {
      this.#seeker.go({});
    }
    return true;
  }
}
