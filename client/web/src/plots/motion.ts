// motion: how the bodies of an island moved, as the answers to GetMotion; their plots; and whether the tick is short
// enough for them. No DOM.
import type {Motion} from "../core/protocol";
import {physics_texts as texts} from "../texts/physics";
import type {PlotContent, SeriesColour} from "./plot_content";

const kept_max = 300; // answers
// The share of bodies that move further than their radius in a tick, as the average of the generation. In a world with
// default parameters, selection makes bodies small and fast until 0.02 of them do.
const nearly_too_long_share = 0.03, too_long_share = 0.1;
// The movement in a tick to which the advised values reduce the fastest body, as a share of its radius.
const advised_movement = 0.5;

/** The answers about one island, oldest first. */
export class MotionHistory {
  #motions: Motion[] = [];

  get motions(): readonly Motion[] {
    return this.#motions;
  }

  clear(): void {
    this.#motions = [];
  }

  /** Adds an answer. It replaces the last one if that has the same tick. If the world has gone back, as a replay can,
   *  the history begins again. */
  add(motion: Motion): void {
    const last = this.#motions[this.#motions.length - 1];
    if (last !== undefined && tick_of(motion) < tick_of(last)) {
      this.#motions = [];
    } else if (last !== undefined && tick_of(motion) === tick_of(last)) {
      this.#motions.pop();
    }
    this.#motions = [...this.#motions, motion].slice(-kept_max);
  }
}

function tick_of(motion: Motion): number {
  return motion.tick ?? 0;
}

/** A quantity that the panel plots. */
export interface Measure {
  name: string;
  unit: string;
  colour: SeriesColour;
  of: (motion: Motion) => number;
  is_count?: boolean;
}

export const measures: readonly Measure[] = [
  {name: texts.kinetic_energy, unit: texts.energy_unit, colour: "orange", of: (motion) => motion.kinetic_energy ?? 0},
  {
    name: texts.momentum,
    unit: texts.momentum_unit,
    colour: "blue",
    of: (motion) => Math.hypot(motion.momentum_x ?? 0, motion.momentum_y ?? 0)
  },
  {name: texts.touching, unit: "", colour: "purple", of: (motion) => motion.touching_count ?? 0, is_count: true},
  {name: texts.overlap, unit: texts.px, colour: "vermilion", of: (motion) => motion.deepest_overlap_px ?? 0},
  {name: texts.fastest, unit: texts.px_s, colour: "green", of: (motion) => motion.fastest_px_s ?? 0},
  {name: texts.movement, unit: texts.radii, colour: "sky", of: (motion) => motion.fastest_step_share ?? 0},
];

/** Builds the plot of a measure over the ticks. */
export function motion_figure(
  {name, unit, colour, of, is_count = false}: Measure, motions: readonly Motion[]): PlotContent {
  const last = motions[motions.length - 1];
  const title = last === undefined ? name : texts.now(name, of(last), unit);
  const series = last === undefined ? [] : [{
    kind: "line" as const,
    name: texts.with_unit(name, unit),
    colour,
    in_legend: false,
    whole: is_count,
    x: motions.map(tick_of),
    y: motions.map(of)
  }];
  return {title, series, x_label: texts.tick, y_label: title, from_zero: true, counted_x: true, empty: texts.none};
}

export interface TickVerdict {
  level: "good"|"nearly too long"|"too long";
  sentence: string; // what was found and, if the tick is too long, what to do
}

/** Judges whether a tick is short enough for the present speeds. */
export function judge_tick(motion: Motion): TickVerdict {
  const too_fast = motion.too_fast_count ?? 0, bodies = motion.body_count ?? 0;
  if (too_fast === 0) {
    return {level: "good", sentence: texts.short_enough(motion.fastest_step_share ?? 0)};
  }
  const per_tick = too_fast / Math.max(motion.generation_tick ?? 0, 1);
  const finding = texts.finding(per_tick, bodies), share = per_tick / Math.max(bodies, 1);
  if (share < nearly_too_long_share) {
    return {level: "good", sentence: texts.short_enough_for_most(finding)};
  }
  return share < too_long_share ? {level: "nearly too long", sentence: texts.nearly_too_long(finding, advice(motion))} :
                                  {level: "too long", sentence: texts.too_long(finding, advice(motion))};
}

/** Recommends values with which the fastest body moves advised_movement of its radius in a tick. */
function advice(motion: Motion): string {
  const movement = motion.fastest_step_share ?? 0, tick_s = motion.tick_s ?? 0;
  if (movement <= advised_movement) { // only an earlier speed was too high
    return texts.advise_half(tick_s / 2);
  }
  return texts.advise(tick_s * advised_movement / movement, (motion.fastest_px_s ?? 0) * advised_movement / movement);
}
