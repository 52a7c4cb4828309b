// Texts of the dialog "New world".
import {with_separators} from "./numbers";

export const new_world_texts = {
  title: "New world",
  experiments: "Experiment",
  /** What an experiment is about, by its name. Its file has an English description. */
  descriptions: {} as {readonly [name: string]: string|undefined},
  same: (world: string) => `same as ${world}`,
  same_help: "The parameters and the schedule that this world has now.",
  name: "name",
  seed: "seed",
  seed_hint: "empty: chosen at random",
  seed_help: "The seed determines everything that is random. Two worlds with equal seeds and parameters are equal.",
  population: "first population",
  from_seed: "drawn from the seed",
  population_help: "population_size and island_count follow from the population.",
  copies_help: "All organisms of the first generation are copies of this one.",
  freezer_problem: (why: string) => `The freezer cannot be read. ${why}`,
  text: "Parameters as text",
  text_label: "Text of the experiment",
  text_help: "The text of the experiment. A parameter that it does not name has its default value.",
  open_file: "Open a file …",
  beside: "show it beside this world",
  create: "Create",
  create_and_run: "Create and run",
  unequal_islands: (first: number, other: number) => `first population: got islands of ${with_separators(first)} and ${
    with_separators(other)} organisms, allowed the same number on each island`,
};
