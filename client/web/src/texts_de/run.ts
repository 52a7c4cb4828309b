// Texts of the panel "Run".
import type * as english from "../texts/run";

import {with_separators} from "./numbers";

export const run_texts: typeof english.run_texts = {
  ticks: "Ticks",
  generations: "Generationen",
  of_ticks: "Ticks",
  of_generations: "Generationen",
  one_tick: "Ein Tick",
  one_tick_help: "Ein Tick, dann anhalten (.).",
  step: "Ticks laufen lassen",
  step_help: "So viele Ticks, dann anhalten.",
  run: "Generationen laufen lassen",
  run_help: "So viele Generationen bis zu ihrem Ende, dann warten.",
  has_ended: "Der Lauf ist zu Ende.",
  ended: (state, outcome) => `${state}: ${outcome}`,
  until: (state, generation) => `${state} bis Generation ${with_separators(generation)}`,
  state: (world, state) => `${world}: ${state}`,
  waits: (rated, islands) => `Ein Programm muss die Fitness senden; ${with_separators(rated)} von ${
    with_separators(islands)} ${islands === 1 ? "Insel" : "Inseln"} bewertet`,
  where: (generation, tick, seed) => `${generation === null ? "" : `Generation ${with_separators(generation)}, `}Tick ${
    with_separators(tick)}, Startwert ${seed}`,
  reset_title: "Zurücksetzen",
  reset_about: "Beginnt einen neuen Lauf bei Generation 1 mit den jetzigen Werten der Parameter.",
  seed: "Startwert",
  seed_hint: "leer: derselbe",
  reset: "Zurücksetzen …",
  ask_reset: (world, seed) =>
    `${world} bei Generation 1 ${seed ? `mit Startwert ${seed}` : "mit demselben Startwert"} neu beginnen?`,
  do_reset: "Welt zurücksetzen",
};
