// Texts of the panel "Worlds".
import {with_separators} from "./numbers";

export const worlds_texts = {
  table: "Worlds of the server",
  headings: ["World", "State", "Generation", "Tick", "Speed"],
  damaged: "damaged",
  slower: (speed: string) => `${speed} (slower)`,
  create: "New world …",
  create_help: "Creates a world, next to those that exist.",
  fork: "Fork …",
  fork_help: "Creates a world that starts from the tick shown.",
  remove: "Delete …",
  return_first: "The shown world is a replay; return to the live world first.",
  ask_remove: (world: string) => `Delete the world ${world}? It ends for all clients.`,
  file_stays: "If the server stores runs, the run file stays in its folder.",
  do_remove: "Delete the world",
  fork_from: (world: string, generation: number, tick: number) => `A copy of ${world} at generation ${
    with_separators(generation)}, tick ${with_separators(tick)}. It waits until it is run.`,
  fork_name: "Name of the fork",
  do_fork: "Fork",
  islands: (world: string) => `Islands of ${world}`,
  islands_of_replay: (world: string) => `Islands of the replay of ${world}`,
  island_table: "Islands of the world",
  island_headings: ["Island", "Alive", "Mean health", "Last best fitness"],
  island: (number: number) => `island ${number}`,
  alive: (alive: number, all: number) => `${with_separators(alive)} of ${with_separators(all)}`,
};
