// Texts of the panel "Run".
import {with_separators} from "./numbers";

export const run_texts = {
  ticks: "Ticks",
  generations: "Generations",
  of_ticks: "ticks", // the names of the fields in errors
  of_generations: "generations",
  one_tick: "One tick",
  one_tick_help: "Runs one tick, then pauses (.).",
  step: "Step ticks",
  step_help: "Runs this many ticks, then pauses.",
  run: "Run generations",
  run_help: "Runs this many generations to their end, then waits.",
  has_ended: "The run has ended.",
  ended: (state: string, outcome: string) => `${state}: ${outcome}`,
  until: (state: string, generation: number) => `${state} until generation ${with_separators(generation)}`,
  state: (world: string, state: string) => `${world}: ${state}`,
  waits: (rated: number, islands: number) => `A client has to send the fitness; ${with_separators(rated)} of ${
    with_separators(islands)} ${islands === 1 ? "island" : "islands"} rated`,
  /** generation: null before the first snapshot */
  where: (generation: number|null, tick: number, seed: number|bigint) =>
    `${generation === null ? "" : `generation ${with_separators(generation)}, `}tick ${with_separators(tick)}, seed ${
      seed}`,
  reset_title: "Reset",
  reset_about: "Starts a new run at generation 1 with the current parameter settings.",
  seed: "Seed",
  seed_hint: "empty: the same seed",
  reset: "Reset …",
  ask_reset: (world: string, seed: string) =>
    `Restart ${world} at generation 1 ${seed ? `with seed ${seed}` : "with the same seed"}?`,
  do_reset: "Reset the world",
};
