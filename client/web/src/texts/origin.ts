// What people read about the generations before a fork.
import {with_separators} from "./numbers";

export const origin_texts = {
  bred_in: (generation: number, world: string) =>
    `Generation ${with_separators(generation)} bred in the world ${world}, before this fork began.`,
  no_world: (generation: number) => `Generation ${with_separators(generation)} bred before this fork began, in a run ` +
    "that no world of this server has now.",
  open: (world: string) => `Open it in ${world}`,
  open_help: "Shows the generation in the world that was forked, next to this one.",
};
