// The help of the keys and gestures. panels.js contains it.
/** The names of keys where they are not those of keys.ts. */
export const key_names: {readonly [name: string]: string|undefined} = {};

export const key_help = {
  pause: "run, pause, resume",
  tick: "one tick, then pause",
  ticks: "60 ticks, then pause",
  faster: "double the speed",
  slower: "halve the speed",
  real_time: "real time",
  maximum: "maximum speed; again: the previous speed",
  next_island: "next island",
  previous_island: "previous island",
  all_islands: "show all islands, or only the chosen one",
  next_world: "next world",
  replay: "replay the run of the world; again: the live world",
  previous_generation: "in a replay: the previous generation",
  next_generation: "in a replay: the next generation",
  beside: "choose a second world, or the past of this one, and show both; again: only the first world",
  evolution: "show generation 1 next to the present; again: only the present",
  other_world: "move the focus to the other world",
  link: "link the views of two worlds, or unlink them",
  fit: "show the whole island",
  zoom: "zoom in, zoom out",
  move: "move the view",
  follow: "follow the selected organism; again: stop",
  colour: "colour by health, lineage, a gene, nothing",
  perception: "perception radii: of the organism at the pointer, of all, of none",
  forces: "forces: of the organism at the pointer, of all, of none",
  trails: "show or hide trails",
  column: "hide the column; again: show it",
  help: "show or hide this help",
  escape: "close the help, end a tool, select no organism, return to all islands",
};

/** What is done, and what it does. Several names of one key are divided by three blanks. */
export const gesture_help: readonly[string, string][] = [
  ["Ctrl+C", "copy a link to this moment"],
  ["Ctrl+Z", "undo your last change of parameters, or what you placed last"],
  ["Ctrl+Shift+Z   Ctrl+Y", "do again what was undone"],
  ["Wheel   pinch", "zoom at the pointer"],
  ["Drag", "move the view"],
  ["Click   tap", "select an organism; on empty space: select none; or use the chosen tool"],
];
