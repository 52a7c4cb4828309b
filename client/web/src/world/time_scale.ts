// TimeScale: positions on the time line of a run. Each generation has the same width; its ticks are evenly spaced
// within it. TimeZoom: the part of the run that the line shows. No DOM.
import {nice_step} from "../texts/numbers";

/** The moments of a run that can be shown. Ticks are counted from the start of the run. */
export interface RunRange {
  first_generation: number;
  last_generation: number;
  first_tick: number;
  last_tick: number;
}

/** A moment of a run. Without a generation, the tick is counted from the start of the run. Without both, it is the last
 *  stored moment. */
export interface Moment {
  generation?: number;
  tick?: number;
}

/** The first and the last tick of a generation; null if the page does not know them. */
export type TicksOf = (generation: number) => {
  first: number;
  last: number
}|null;

const span_min = 2; // generations that are shown at least
const exact_px = 6; // in narrower generations, a position means the first moment

/** The generations that a time line shows, from the beginning of `from` to that of `to`. They need not be whole. */
export interface ShownGenerations {
  from: number;
  to: number;
}

/** All generations of a run. */
export function whole_run({first_generation, last_generation}: RunRange): ShownGenerations {
  return {from: first_generation, to: last_generation + 1};
}

export class TimeScale {
  readonly #ticks_of: TicksOf;

  /** shown: the part of the range that the line shows. */
  constructor(readonly range: RunRange, ticks_of: TicksOf, readonly shown: ShownGenerations = whole_run(range)) {
    this.#ticks_of = ticks_of;
  }

  get #count(): number {
    return this.shown.to - this.shown.from;
  }

  /** The position of a moment: from 0 to 1 on the line, outside that if the line does not show it. tick: since the run
   *  began. */
  part_of(generation: number, tick?: number): number {
    const ticks = tick === undefined ? null : this.#ticks_of(generation), {from, to} = whole_run(this.range);
    const within = ticks && ticks.last > ticks.first ? (tick! - ticks.first) / (ticks.last - ticks.first) : 0;
    return (Math.min(Math.max(generation + clamp(within), from), to) - this.shown.from) / this.#count;
  }

  /** The moment at a position from 0 to 1 of a line of this width. */
  moment_at(part: number, width_px: number): Moment&{generation: number} {
    const {last_generation} = this.range, at = this.shown.from + clamp(part) * this.#count;
    const generation = Math.min(Math.floor(at + 1e-9), last_generation), ticks = this.#ticks_of(generation);
    const is_end = generation === last_generation && part >= 1;
    if (ticks === null || (width_px / this.#count < exact_px && !is_end)) {
      return {generation};
    }
    const within = clamp(at - generation);
    return {generation, tick: ticks.first + Math.round(within * (ticks.last - ticks.first))};
  }
}

/** The part of a run that the time line shows. It moves with the present if it ends there. */
export class TimeZoom {
  #shown: ShownGenerations|null = null; // null: all
  #follows = false; // the line ends at the present

  /** Whether the line shows a part only. */
  get is_on(): boolean {
    return this.#shown !== null;
  }

  shown(range: RunRange): ShownGenerations {
    const all = whole_run(range);
    if (this.#shown === null) {
      return all;
    }
    if (this.#shown.from < all.from - 1 || (this.#shown.to > all.to && !this.#follows)) {
      this.#set(this.#shown, all); // another run
    } else if (this.#follows && this.#shown !== null) {
      const span = this.#shown.to - this.#shown.from;
      this.#shown = {from: Math.max(all.to - span, all.from), to: all.to};
    }
    return this.#shown ?? all;
  }

  /** Shows 1 / factor of what is shown; the moment at `part` stays where it is. */
  zoom(range: RunRange, part: number, factor: number): void {
    const {from, to} = this.shown(range), all = whole_run(range);
    const least = Math.min(span_min, all.to - all.from), at = from + part * (to - from);
    const span = Math.min(Math.max((to - from) / factor, least), all.to - all.from);
    this.#set({from: at - part * span, to: at + (1 - part) * span}, all);
  }

  /** Moves the line by this part of its width: 0.5 shows later generations. */
  pan(range: RunRange, parts: number): void {
    const {from, to} = this.shown(range), by = parts * (to - from);
    if (this.#shown !== null) {
      this.#set({from: from + by, to: to + by}, whole_run(range));
    }
  }

  /** Moves the line so that it shows this generation. */
  include(range: RunRange, generation: number): void {
    const {from, to} = this.shown(range), span = to - from;
    const behind = from - generation, beyond = generation + 1 - to, by = behind > 0 ? -behind : Math.max(beyond, 0);
    this.pan(range, by / span);
  }

  show_all(): void {
    this.#shown = null;
  }

  /** Keeps the part within the run. */
  #set({from, to}: ShownGenerations, all: ShownGenerations): void {
    const span = Math.min(to - from, all.to - all.from), begin = Math.min(Math.max(from, all.from), all.to - span);
    this.#shown = span >= all.to - all.from ? null : {from: begin, to: begin + span};
    this.#follows = begin + span >= all.to - 1e-6;
  }
}

/** The generations that have a label: multiples of 1, 2 or 5 times a power of ten, at most count_max. */
export function marked_generations(first: number, last: number, count_max: number): number[] {
  if (count_max < 1 || last < first) {
    return [];
  }
  const count = (step: number): number => Math.floor(last / step) - Math.floor((first - Math.min(first, 1)) / step);
  let step = 1;
  while (count(step) > count_max) {
    step = nice_step(1.5 * step);
  }
  const marked: number[] = [];
  for (let generation = Math.ceil(first / step) * step; generation <= last; generation += step) {
    marked.push(generation);
  }
  return marked;
}

/** A mark on the time line. part: from 0 to 1. */
export interface PlacedMark {
  part: number;
  kind: string;
  label: string;
  text: string;
}

/** Marks of one place on the time line. */
export interface JoinedMark {
  part: number;
  texts: string[];
  first: PlacedMark;
}

/** Joins marks of one kind that would overlap: at most `slots` of each kind remain, and each has the texts of its
 *  marks. */
export function joined_marks(marks: readonly PlacedMark[], slots: number): JoinedMark[] {
  const by_slot = new Map<string, JoinedMark>();
  for (const mark of marks) {
    const slot = `${mark.kind} ${Math.floor(mark.part * slots)}`, known = by_slot.get(slot);
    if (known) {
      known.texts.push(mark.text);
    } else {
      by_slot.set(slot, {part: mark.part, texts: [mark.text], first: mark});
    }
  }
  return [...by_slot.values()];
}

function clamp(part: number): number {
  return Math.min(Math.max(part, 0), 1);
}
