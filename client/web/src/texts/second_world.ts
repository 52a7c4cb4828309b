// What people read when they choose a second world.
import {with_separators} from "./numbers";

export const second_world_texts = {
  title: "Show next to this world",
  world_hint: (generation: number, state: string) => `generation ${with_separators(generation)}, ${state}`,
  damaged: "damaged",
  live: (world: string) => `${world}, live`,
  live_hint: "the present of the world whose past is shown",
  past: (generation: number, world: string) => `Generation ${with_separators(generation)} of ${world}`,
  past_hint: "its past, in a replay",
  generation: "generation",
  fork: (world: string) => `A fork of ${world}`,
  fork_hint: "a new world that starts from the moment shown",
};
