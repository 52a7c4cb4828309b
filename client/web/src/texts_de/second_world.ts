// What people read when they choose a second world.
import type * as english from "../texts/second_world";

import {with_separators} from "./numbers";

export const second_world_texts: typeof english.second_world_texts = {
  title: "Neben dieser Welt zeigen",
  world_hint: (generation, state) => `Generation ${with_separators(generation)}, ${state}`,
  damaged: "beschädigt",
  live: (world) => `${world}, live`,
  live_hint: "die Gegenwart der Welt, deren Vergangenheit gezeigt wird",
  past: (generation, world) => `Generation ${with_separators(generation)} von ${world}`,
  past_hint: "ihre Vergangenheit, als Wiedergabe",
  generation: "Generation",
  fork: (world) => `Eine Abzweigung von ${world}`,
  fork_hint: "eine neue Welt, die beim gezeigten Moment beginnt",
};
