// Timeline: the strip below an island: the generations of the run from the first to the present. The user drags along
// the line to show the past in a replay, plays the replay, and returns to the live world. Marks show changes of
// parameters and extinctions.
//
// Owner    App; one per pane.
// Seeking  While a seek runs, only the newest moment that the user asks for is kept.
import {marks_of} from "../plots/change_marks";
import {number_in, with_separators} from "../texts/numbers";
import {capitalised} from "../texts/texts";
import {timeline_texts} from "../texts/timeline";
import {guarded_button, set_allowed, set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";

import {
  joined_marks,
  marked_generations,
  TimeScale,
  type JoinedMark,
  type Moment,
  type RunRange
} from "../world/time_scale";
import type {GenerationStatistics} from "../core/protocol";
import type {ViewedWorld} from "../world/world";

const label_room_px = 56; // between labels
const mark_slots = 160; // marks on the line at most, of each kind
const rebuild_ms = 250; // between two rebuilds of labels and marks
const texts_max = 3; // of marks at the pointer
const key_ticks = 60, page_generations = 10;
const steps: {[key: string]: number} = {
  ArrowLeft: -1,
  ArrowDown: -1,
  ArrowRight: 1,
  ArrowUp: 1
};
const extinctions_share_max = 0.1; // if more generations end so, extinctions are the rule and have no marks

export interface TimelineContext {
  notify(text: string): void;
  attempt(what: () => Promise<unknown>): Promise<boolean>;
  copy_link(world: ViewedWorld): void;
}

export class Timeline {
  readonly element: HTMLElement;

  #line: HTMLElement;
  #fill = h("div", {class: "time-fill"});
  #knob = h("div", {class: "time-knob"});
  #labels = h("div", {class: "time-labels"});
  #marks = h("div", {class: "time-marks"});
  #bubble = h("div", {class: "time-bubble", hidden: true});
  #problem = h("p", {class: "hint grow"});
  #field = h("input", {
    class: "field time-generation",
    inputmode: "numeric",
    autocomplete: "off",
    onkeydown: (event: KeyboardEvent) => this.#type(event),
    onblur: () => this.#end_typing()
  });
  #field_label = h("label", {class: "hint time-field"}, timeline_texts.generation, this.#field);
  #wrong = h("p", {class: "error time-wrong", role: "alert"});
  #place = h("span", {class: "time-place hint"});
  #first: HTMLButtonElement;
  #previous: HTMLButtonElement;
  #play: HTMLButtonElement;
  #next: HTMLButtonElement;
  #last: HTMLButtonElement;
  #live: HTMLButtonElement;
  #buttons: HTMLElement;
  #ends: (() => void)[] = [];
  #width_px = 0;
  #pressed = false;
  #dragged: number|null = null; // where the pointer is while it is pressed, and was until the last seek is answered
  #hovered: number|null = null;
  #waiting: Moment|null = null;
  #seeking = false;
  #extinctions: number[] = []; // generations, oldest first
  /** How far #extinctions describes the history. */
  #scanned: {first: GenerationStatistics|undefined; island: number; generation: number}|null = null;
  #texts: JoinedMark[] = [];
  #drawn = ""; // what labels and marks show
  #rebuilt_ms = -rebuild_ms;
  #timer = 0;

  readonly #world: ViewedWorld;
  readonly #context: TimelineContext;

  constructor(world: ViewedWorld, context: TimelineContext) {
    this.#world = world;
    this.#context = context;
    const button = (label: string, name: string, act: () => void, classes = "button"): HTMLButtonElement => {
      const made = guarded_button(label, context.notify, act, classes);
      made.setAttribute("aria-label", name);
      return made;
    };
    this.#first = button("|<", "First tick", () => this.#to_first(), "button square time-end");
    const attempt = (what: () => Promise<unknown>) => (): void => this.#attempt(what);
    this.#previous =
      button("<", "Previous generation", attempt(() => world.past.move_generations(-1)), "button square");
    this.#play =
      guarded_button("Play", context.notify, attempt(() => world.control.pause_or_resume()), "button time-play");
    this.#next = button(">", "Next generation", attempt(() => world.past.move_generations(1)), "button square");
    this.#last = button(">|", "Last tick", () => this.#go({}), "button square time-end");
    this.#live = guarded_button("Live", context.notify, attempt(() => world.past.back_to_live()), "button time-live");
    const copy =
      h("button", {
        type: "button",
        class: "button time-copy",
        title: "Copies a link that shows this moment in a browser (Ctrl+C).",
        onclick: () => context.copy_link(world),
      },
        "Copy link");
    this.#line =
      h("div", {
        class: "time-line",
        tabindex: 0,
        role: "slider",
        "aria-label": "Time line: generation",
        onpointerdown: (event: PointerEvent) => this.#press(event),
        onpointermove: (event: PointerEvent) => this.#move(event),
        onpointerup: () => this.#release(),
        onpointercancel: () => this.#release(),
        onpointerleave: () => this.#hover(null),
        onkeydown: (event: KeyboardEvent) => this.#key(event),
      },
        this.#labels, h("div", {class: "time-bar"}, this.#fill), this.#marks, this.#knob, this.#bubble);
    this.#buttons =
      h("div", {class: "time-buttons"}, this.#first, this.#previous, this.#play, this.#next, this.#last,
        this.#field_label, this.#place);
    this.element =
      h("div", {class: "timeline", role: "group", "aria-label": "Time line"}, this.#buttons, this.#line, this.#problem,
        h("div", {class: "time-buttons time-right"}, this.#live, copy), this.#wrong);
    const observer = new ResizeObserver((entries) => {
      this.#width_px = entries[entries.length - 1]!.contentRect.width;
      this.#refresh();
    });
    observer.observe(this.#line);
    this.#ends.push(() => observer.disconnect(), () => clearTimeout(this.#timer));
    this.#ends.push(world.changes.listen(() => this.#refresh()));
    this.#refresh();
  }

  close(): void {
    this.#ends.forEach((end) => end());
  }

  // ---- what is shown ----

  #scale(): TimeScale|null {
    const range = this.#world.past.range;
    return range && new TimeScale(range, (generation) => this.#world.past.ticks_of(generation));
  }

  #refresh(): void {
    const world = this.#world, scale = this.#scale(), snapshot = world.snapshot, is_past = world.is_replay;
    this.element.hidden = !world.name;
    set_attribute(this.element, "data-past", String(is_past));
    const problem = world.past.is_own_replay || !scale ? "" : world.past.problem;
    set_text(this.#problem, problem);
    this.#line.hidden = problem !== "";
    this.#refresh_buttons(problem);
    if (!scale || !snapshot) {
      return;
    }
    const target = world.past.target;
    const shown_part = is_past ? scale.part_of(snapshot.generation, snapshot.tick) : 1;
    const part = this.#dragged ?? this.#place_of(scale, target) ?? shown_part;
    this.#knob.style.left = this.#fill.style.width = `${(100 * part).toFixed(3)}%`;
    const ticks = world.past.ticks_of(snapshot.generation), count = ticks ? ticks.last - ticks.first : 0;
    const generation_text = `generation ${with_separators(snapshot.generation)}`;
    const tick_text = `tick ${with_separators(snapshot.generation_tick)}`;
    const of = is_past && count >= snapshot.generation_tick ? ` of ${with_separators(count)}` : "";
    set_text(this.#place, target ? `going to ${moment_text(target)} …` : tick_text + of);
    set_attribute(this.#line, "aria-valuemin", String(scale.range.first_generation));
    set_attribute(this.#line, "aria-valuemax", String(scale.range.last_generation));
    set_attribute(this.#line, "aria-valuenow", String(snapshot.generation));
    set_attribute(this.#line, "aria-valuetext", `${is_past ? tick_text : "live"}, ${generation_text}`);
    this.#refresh_field(scale, target?.generation ?? snapshot.generation);
    this.#rebuild_soon(scale);
    this.#show_bubble(scale);
  }

  /** Shows the generation in the field, unless the user types there. */
  #refresh_field(scale: TimeScale, generation: number): void {
    const title = timeline_texts.generation_help(this.#first_generation(scale.range), scale.range.last_generation);
    set_attribute(this.#field, "title", title);
    if (document.activeElement !== this.#field) {
      this.#field.value = String(generation);
    }
  }

  /** The position of the moment that a seek leads to; null if the page does not know it. */
  #place_of(scale: TimeScale, target: Moment|null): number|null {
    if (target?.generation === undefined) {
      return null;
    }
    const ticks = this.#world.past.ticks_of(target.generation);
    return scale.part_of(target.generation, ticks && target.tick !== undefined ? ticks.first + target.tick : undefined);
  }

  #refresh_buttons(problem: string): void {
    const world = this.#world, {snapshot, past: {range}} = world, generation = snapshot?.generation ?? 1;
    const runs = world.is_replay && world.control.state === "RUN_STATE_RUNNING";
    const why = !world.is_replay ? "The world is live; P replays its run." :
      world.past.is_own_replay   ? "" :
                                   world.server.why_not("seek", world.shown);
    const is_first = range !== null && generation <= range.first_generation && snapshot?.generation_tick === 0;
    const is_last = range !== null && generation >= range.last_generation;
    this.#buttons.hidden = problem !== "";
    this.#live.hidden = problem !== "";
    set_text(this.#play, runs ? "Pause" : "Play");
    const why_play = why || (world.control.at_end ? "This is the end of the replay." : "");
    set_allowed(this.#play, why_play, "Plays or pauses the replay (Space).");
    set_allowed(this.#first, problem || (range ? "" : "No world is open."), "Goes to the first tick.");
    const why_previous = problem || (is_first ? "This is the first generation." : "");
    set_allowed(this.#previous, why_previous, "Goes to the previous generation ([).");
    set_allowed(this.#next, why || (is_last ? "This is the last generation." : ""), "Goes to the next generation (]).");
    set_allowed(this.#last, why, "Goes to the last tick.");
    set_allowed(this.#live, world.past.is_own_replay ? "" : "The world is live.", "Returns to the live world (P).");
  }

  // ---- labels and marks ----

  /** Rebuilds labels and marks if they have changed, but not more often than every rebuild_ms. */
  #rebuild_soon(scale: TimeScale): void {
    const world = this.#world, {first_generation, last_generation} = scale.range;
    const of_run = [world.name, world.island, first_generation, last_generation];
    const key =
      [...of_run, world.history.generations.length, world.history.changes.length, Math.round(this.#width_px)].join(" ");
    if (key === this.#drawn || this.#timer !== 0) {
      return;
    }
    const wait = this.#rebuilt_ms + rebuild_ms - performance.now();
    if (wait > 0) {
      this.#timer = window.setTimeout(() => {
        this.#timer = 0;
        this.#refresh();
      }, wait);
      return;
    }
    this.#rebuilt_ms = performance.now();
    this.#drawn = key;
    this.#scan_extinctions();
    const labelled = marked_generations(first_generation, last_generation, Math.floor(this.#width_px / label_room_px));
    this.#labels.replaceChildren(...labelled.map((generation) => {
      const label = h("span", {}, with_separators(generation));
      label.style.left = percent(scale.part_of(generation));
      return label;
    }));
    const inside = (generation: number): boolean => generation >= first_generation && generation <= last_generation;
    const marks_at = (marks: {x: number; text: string}[]): JoinedMark[] => {
      const shown = marks.filter(({x}) => inside(x)).map(({x, text}) => ({part: scale.part_of(x), text}));
      return joined_marks(shown, mark_slots);
    };
    const changes = marks_at(marks_of(world.history.changes));
    const are_rare = this.#extinctions.length <= extinctions_share_max * (last_generation - first_generation + 1);
    const extinctions = marks_at(
      (are_rare ? this.#extinctions : [])
        .map(
          (generation) =>
            ({x: generation, text: `generation ${with_separators(generation)}: all organisms died before its end`})));
    const mark = (kind: string) => ({part}: {part: number}): HTMLElement => {
      const made = h("i", {"data-kind": kind});
      made.style.left = percent(part);
      return made;
    };
    this.#texts = [...changes, ...extinctions];
    this.#marks.replaceChildren(...changes.map(mark("change")), ...extinctions.map(mark("extinction")));
  }

  /** Adds the extinctions of the generations that have ended since the last call. */
  #scan_extinctions(): void {
    const {history: {generations: history}, island} = this.#world;
    if (!this.#scanned || this.#scanned.first !== history[0] || this.#scanned.island !== island) {
      this.#extinctions = [];
      this.#scanned = {first: history[0], island, generation: 0};
    }
    const fresh: number[] = [];
    let i = history.length - 1;
    for (; i >= 0 && history[i]!.generation > this.#scanned.generation; --i) {
      const one = history[i]!;
      if ((one.island ?? 0) === island && (one.alive_count ?? 0) === 0 && (one.organism_count ?? 0) > 0) {
        fresh.push(one.generation);
      }
    }
    this.#extinctions.push(...fresh.reverse());
    this.#scanned.generation = history[history.length - 1]?.generation ?? 0;
  }

  /** Says at the pointer which moment a click shows, and what happened there. */
  #show_bubble(scale: TimeScale): void {
    const at = this.#pressed ? this.#dragged : this.#hovered;
    this.#bubble.hidden = at === null;
    if (at === null) {
      return;
    }
    const moment = scale.moment_at(at, this.#width_px), near = 4 / Math.max(this.#width_px, 1);
    const texts = this.#texts.filter(({part}) => Math.abs(part - at) <= near).flatMap((mark) => mark.texts);
    const first = this.#world.past.ticks_of(moment.generation)?.first;
    const is_exact = moment.tick !== undefined && first !== undefined;
    const place = `generation ${with_separators(moment.generation)}`;
    const tick = is_exact ? `, tick ${with_separators(moment.tick! - first)}` : "";
    const lines = [place + tick, ...texts.slice(0, texts_max)];
    if (texts.length > texts_max) {
      lines.push(`and ${texts.length - texts_max} more`);
    }
    set_text(this.#bubble, lines.join("\n"));
    const half = this.#bubble.offsetWidth / 2, right = Math.max(this.#width_px - half, half);
    this.#bubble.style.left = `${Math.min(Math.max(at * this.#width_px, half), right)}px`;
  }

  // ---- pointer and keys ----

  #part_at(event: PointerEvent): number {
    const {left, width} = this.#line.getBoundingClientRect();
    return Math.min(Math.max((event.clientX - left) / Math.max(width, 1), 0), 1);
  }

  #press(event: PointerEvent): void {
    if (event.pointerType === "mouse" && event.button !== 0) {
      return;
    }
    this.#line.setPointerCapture(event.pointerId);
    this.#pressed = true;
    this.#drag_to(this.#part_at(event));
  }

  #move(event: PointerEvent): void {
    if (this.#pressed) {
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
      this.#go(tick === undefined ? {generation} : {tick});
    }
    this.#refresh();
  }

  #release(): void {
    this.#pressed = false;
    this.#hovered = null;
    if (!this.#seeking) {
      this.#dragged = null;
    }
    this.#refresh();
  }

  #hover(part: number|null): void {
    this.#hovered = part;
    const scale = this.#scale();
    if (scale) {
      this.#show_bubble(scale);
    }
  }

  #key(event: KeyboardEvent): void {
    const world = this.#world, by = steps[event.key] ?? 0;
    if (event.ctrlKey || event.altKey || event.metaKey) {
      return;
    }
    if (by !== 0) {
      if (world.is_replay || by < 0) {
        this.#attempt(() => (event.shiftKey ? world.past.move_ticks(by * key_ticks) : world.past.move_generations(by)));
      }
    } else if (event.key === "PageUp" || event.key === "PageDown") {
      this.#attempt(() => world.past.move_generations(event.key === "PageUp" ? page_generations : -page_generations));
    } else if (event.key === "Home") {
      this.#to_first();
    } else if (event.key === "End") {
      if (world.is_replay) {
        this.#go({});
      }
    } else {
      return;
    }
    event.preventDefault();
  }

  /** The first generation that may be typed. The history of a live world may begin later than its run. */
  #first_generation(range: RunRange): number {
    return this.#world.is_replay ? range.first_generation : 1;
  }

  /** Enter in the field shows the generation that was typed; Escape forgets it. */
  #type(event: KeyboardEvent): void {
    if (event.key === "Escape") {
      this.#field.blur();
    } else if (event.key === "Enter") {
      const range = this.#world.past.range;
      const text = this.#field.value.replace(/,/g, "");
      const wanted =
        range && number_in(timeline_texts.generation, text, this.#first_generation(range), range.last_generation);
      set_text(this.#wrong, typeof wanted === "string" ? `${capitalised(wanted)}.` : "");
      set_attribute(this.#field, "aria-invalid", typeof wanted === "string" ? "true" : null);
      if (typeof wanted === "number") {
        this.#go({generation: wanted});
        this.#field.select();
      }
    }
  }

  #end_typing(): void {
    set_text(this.#wrong, "");
    set_attribute(this.#field, "aria-invalid", null);
    this.#refresh();
  }

  #to_first(): void {
    const range = this.#world.past.range;
    if (range) {
      this.#go({generation: range.first_generation});
    }
  }

  #attempt(what: () => Promise<unknown>): void {
    void this.#context.attempt(what);
  }

  /** Shows a moment, after the running seek if there is one. */
  #go(moment: Moment): void {
    this.#waiting = moment;
    if (!this.#seeking) {
      void this.#seek();
    }
  }

  async #seek(): Promise<void> {
    this.#seeking = true;
    while (this.#waiting) {
      const moment = this.#waiting;
      this.#waiting = null;
      if (!(await this.#context.attempt(() => this.#world.past.show_nearest(moment)))) {
        this.#waiting = null;
      }
    }
    this.#seeking = false;
    if (!this.#pressed) {
      this.#dragged = null;
    }
    this.#refresh();
  }
}

function percent(part: number): string {
  return `${(100 * part).toFixed(3)}%`;
}

function moment_text({generation, tick}: Moment): string {
  return generation !== undefined ? `generation ${with_separators(generation)}` :
    tick !== undefined ? `tick ${with_separators(tick)}` :
                         "the last tick";
}
