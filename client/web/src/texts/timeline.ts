// What people read about the past of a world: the time line, its buttons, links to moments.
import {with_separators} from "./numbers";

export const timeline_texts = {
  name: "Time line",
  slider: "Time line: generation",
  generation: (generation: number) => `generation ${with_separators(generation)}`,
  tick: (tick: number) => `tick ${with_separators(tick)}`,
  tick_of: (tick: number, count: number) => `tick ${with_separators(tick)} of ${with_separators(count)}`,
  last_tick: "the last tick",
  going_to: (moment: string) => `going to ${moment} …`,
  live: "live",
  is_live: "The world is live.",
  is_live_help: "The world is live; P replays its run.",
  no_world: "No world is open.",
  is_first: "This is the first generation.",
  is_last: "This is the last generation.",
  is_end: "This is the end of the replay.",
  extinction: (generation: number) => `generation ${with_separators(generation)}: all organisms died before its end`,
  forked: (world: string) => `The world ${world} was forked from here.`,
  mark_labels: {extinction: "all died", placed: "placed", removed: "removed", migration: "migration", fork: "fork"},
  several: (label: string, further: number) => `${label} +${further}`,
  zoomed: (first: number, last: number) =>
    `the line shows the generations ${with_separators(first)} to ${with_separators(last)}`,
  zoom: "Zoom of the time line",
  further_marks: (count: number) => `and ${count} more`,
};

export const timeline_buttons = {
  first: {label: "|<", name: "First tick", help: "Goes to the first tick."},
  previous: {label: "<", name: "Previous generation", help: "Goes to the previous generation ([)."},
  play: {label: "Play", help: "Plays or pauses the replay (Space)."},
  pause: {label: "Pause"},
  next: {label: ">", name: "Next generation", help: "Goes to the next generation (])."},
  last: {label: ">|", name: "Last tick", help: "Goes to the last tick."},
  live: {label: "Live", help: "Returns to the live world (P)."},
  zoom_in: {label: "+", name: "Zoom in", help: "Shows fewer generations on the line (wheel, + on the line)."},
  zoom_out: {label: "−", name: "Zoom out", help: "Shows more generations on the line (wheel, − on the line)."},
  show_all: {label: "All", name: "Show all generations", help: "Shows the whole run on the line (0 on the line)."},
  is_whole: "The line shows the whole run.",
  copy: {label: "Copy link", help: "Copies a link that shows this moment in a browser (Ctrl+C)."},
};

export const generation_field_texts = {
  label: (births: boolean): string => (births ? "interval" : "generation"),
  help: (first: number, last: number, births: boolean) =>
    `Type ${births ? "an interval" : "a generation"} from ${with_separators(first)} to ${with_separators(last)}, ` +
    "and press Enter to show it.",
};
