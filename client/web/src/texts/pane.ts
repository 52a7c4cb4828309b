// What people read in and above an island: its name, hints, tiles of all islands, the views of two worlds.
import type {Tool} from "../core/messages";
import {fitness_text, with_separators} from "./numbers";

function organisms(count: number): string {
  return count === 1 ? "1 organism" : `${with_separators(count)} organisms`;
}

export const pane_texts = {
  frozen: "frozen",
  kind: "island",
  shown: "Shown worlds",
  no_webgl: "This browser cannot draw the island, because it has no WebGL 2, or WebGL 2 is switched off. " +
    "The panels show the world as usual.",
  no_world: "No world is shown",
  island: (island: number, world: string, alive: string) =>
    `Island ${island} of world ${world}${alive}. Arrow keys move the view, 0 shows the whole island.`,
  alive: (generation: number, alive: number) =>
    `, generation ${with_separators(generation)}, ${organisms(alive)} alive`,
  start: "▶ Start",
  start_help: "Takes part, and runs this world.",
  waiting: "Waiting for the first snapshot …",
  world: "World",
  world_named: (name: string, is_replay: boolean) => `World ${name}${is_replay ? ", replay" : ""}`,
  generation: (generation: number, has_births: boolean) =>
    `${has_births ? "Interval" : "Generation"} ${with_separators(generation)}`,
  replay_of: (world: string) => `REPLAY of ${world}`,
  a_file: "a file",
  not_connected: "not connected",
  silent: (seconds: number) => `no data for ${seconds} s`,
  end_of_replay: "end of the replay",
  slower: " slower",
  close: "Close this world",
  beside: "Choose a second world to show next to this one (B)",
};

/** How much room a tile has for its label. */
export type LabelWidth = "wide"|"middle"|"narrow";

export const tile_texts = {
  show: "All islands",
  show_help: (islands: number) => `Shows all ${with_separators(islands)} islands at once (I).`,
  hide_help: (island: number) => `Shows only island ${island} (I, Esc).`,
  back_help: "Returns to all islands (I, Esc).",
  too_many: (islands: number, most: number) =>
    `This world has ${with_separators(islands)} islands; at most ${most} can be shown at once.`,
  only_one: "This world has only one island.",
  group: (world: string) => `All islands of world ${world}. Arrow keys choose an island, Enter shows only this one.`,
  name: (island: number, width: LabelWidth) => width === "wide" ? `Island ${island}` : String(island),
  facts: (alive: number, fitness: number|null, width: LabelWidth) => with_separators(alive) +
    (width === "narrow" ? "" : " alive") +
    (width === "wide" && fitness !== null ? ` · fitness ${fitness_text(fitness)}` : ""),
  waiting: (island: number) => `Island ${island}. Waiting for the first snapshot.`,
  /** fitness: the mean of the generation before; null: not known. */
  label: (island: number, generation: number, alive: number, health: number, fitness: number|null) =>
    `Island ${island}: generation ${with_separators(generation)}, ${organisms(alive)} alive, ` +
    `mean health ${health.toFixed(1)}` +
    (fitness === null ? "" : `, mean fitness of the generation before ${fitness_text(fitness)}`) + ".",
};

export const link_texts = {
  name: "Link the views",
  help: "Both worlds move and zoom together (K).",
  linked: "Both worlds move and zoom together.",
  unlinked: "Each world moves and zooms by itself.",
  one_world: "Only one world is shown; B shows a second one.",
};

export const tool_texts = {
  group: "Click",
  no_place: "This server cannot place or remove anything; a newer version of evod can.",
  no_world: "No world is open.",
  is_replay: "A replay cannot be changed; fork it, and change the fork.",
  no_organism: "Select an organism to place copies of it.",
  copy_of: (organism: number) => `a copy of organism ${organism}`,
  nothing_to_remove: "Nothing to remove here",
  place: {food: "Place food", poison: "Place poison"},
  place_organism: (name: string|null) => `Place ${name ?? "an organism"}`,
  remove_organism: (organism: number) => `Remove organism ${organism}`,
  remove: {food: "Remove food", poison: "Remove poison"},
};

/** A button of a tool: what a click on the island does. */
export interface ToolButton {
  tool: Tool;
  label: string;
  help: string;
}

export const tool_buttons: readonly ToolButton[] = [
  {tool: "select", label: "Select", help: "A click in the island selects the organism there (Esc)."},
  {tool: "food", label: "Food", help: "A click in the island places food. It does not reappear when it is eaten."},
  {
    tool: "poison",
    label: "Poison",
    help: "A click in the island places poison. It does not reappear when it is eaten."
  },
  {tool: "organism", label: "Organism", help: "A click in the island places a copy of the selected organism."},
  {
    tool: "remove",
    label: "Remove",
    help: "A click in the island removes the organism, food or poison there until the generation ends."
  },
];
