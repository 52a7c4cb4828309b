// TimeScale: positions on the time line of a run. Each generation has the same width; its ticks are evenly spaced
// within it. Pure functions.
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

const exact_px = 6; // in narrower generations, a position means the first moment

export class TimeScale {
  readonly #ticks_of: TicksOf;

  constructor(readonly range: RunRange, ticks_of: TicksOf) {
    this.#ticks_of = ticks_of;
  }

  get #count(): number {
    return this.range.last_generation - this.range.first_generation + 1;
  }

  /** The position of a moment, from 0 to 1. tick: since the run began. */
  part_of(generation: number, tick?: number): number {
    const ticks = tick === undefined ? null : this.#ticks_of(generation);
    const within = ticks && ticks.last > ticks.first ? (tick! - ticks.first) / (ticks.last - ticks.first) : 0;
    return clamp((generation - this.range.first_generation + clamp(within)) / this.#count);
  }

  /** The moment at a position from 0 to 1 of a line of this width. */
  moment_at(part: number, width_px: number): Moment&{generation: number} {
    const {first_generation, last_generation} = this.range, at = clamp(part) * this.#count;
    const generation = Math.min(first_generation + Math.floor(at), last_generation), ticks = this.#ticks_of(generation);
    const is_end = generation === last_generation && part >= 1;
    if (ticks === null || (width_px / this.#count < exact_px && !is_end)) {
      return {generation};
    }
    const within = clamp(at - (generation - first_generation));
    return {generation, tick: ticks.first + Math.round(within * (ticks.last - ticks.first))};
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

/** Marks of one place on the time line. part: from 0 to 1. */
export interface JoinedMark {
  part: number;
  texts: string[];
}

/** Joins marks that would overlap: at most `slots` remain, and each has the texts of its marks. */
export function joined_marks(marks: readonly {
  part: number;
  text: string
}[], slots: number): JoinedMark[] {
  const by_slot = new Map<number, JoinedMark>();
  for (const {part, text} of marks) {
    const slot = Math.floor(part * slots), known = by_slot.get(slot);
    if (known) {
      known.texts.push(text);
    } else {
      by_slot.set(slot, {part, texts: [text]});
    }
  }
  return [...by_slot.values()];
}

function clamp(part: number): number {
  return Math.min(Math.max(part, 0), 1);
}
