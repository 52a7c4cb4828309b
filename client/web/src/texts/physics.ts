// physics: the panel "Physics": how the bodies of an island move, and whether a tick is short enough for them.
import {shown_number, significant, three_digits, with_separators, with_unit} from "./numbers";

export const physics_texts = {
  title: "Physics",
  tick: "tick",
  waiting: "Waiting for the first numbers …",
  none: "no numbers yet",
  now: (name: string, value: number, unit: string) => `${name}: ${with_unit(Number(value.toPrecision(6)), unit)}`,
  with_unit: (name: string, unit: string) => (unit === "" ? name : `${name}, ${unit}`),
  kinetic_energy: "kinetic energy",
  energy_unit: "kg px²/s²",
  momentum: "momentum of all bodies together",
  momentum_unit: "kg px/s",
  touching: "pairs of bodies that touch",
  overlap: "deepest overlap",
  fastest: "fastest body",
  movement: "movement of the fastest body in a tick",
  px: "px",
  px_s: "px/s",
  radii: "of its radius",

  bodies: (bodies: number, pairs: number, tick_s: number) =>
    `${with_separators(bodies)} ${bodies === 1 ? "body" : "bodies"} (organisms and crates), ${with_separators(pairs)} ${
      pairs === 1 ? "pair touches" : "pairs touch"}; a tick of ${shown_number(tick_s)} s.`,
  details: (step_px: number, strip_px: number, overlap_share: number) =>
    `The fastest body moves ${significant(step_px)} px in a tick; the search for contacts uses strips of ${
      shown_number(strip_px)} px. The deepest overlap is ${significant(overlap_share)} of the smaller body's radius.`,
  counts: (too_fast: number, limited: number) =>
    `In this generation, ${with_separators(too_fast)} ${
      too_fast === 1 ? "move was" :
                       "moves were"} longer than the radius of the body, and max_speed_px_s limited the speed ` +
    `of a body ${with_separators(limited)} ${limited === 1 ? "time" : "times"}.`,
  integrators: "How far positions depend on the length of a tick: `evod check --integrators` moves a body with both " +
    "integrators of the server and compares the positions with the exact solution.",

  short_enough: (movement: number) =>
    `The tick is short enough: the fastest body moves ${significant(movement)} of its radius in a tick.`,
  short_enough_for_most: (finding: string) => `The tick is short enough: only ${finding}`,
  nearly_too_long: (finding: string, advice: string) => `The tick is nearly too long: ${finding} ${advice}`,
  too_long: (finding: string, advice: string) => `The tick is too long: ${finding} ${advice}`,
  finding: (bodies: number, of: number) =>
    `on average ${significant(bodies)} of ${
      with_separators(of)} bodies move further than their radius in a tick of this ` +
    "generation. Two such bodies that meet may pass through each other.",
  advise_half: (tick_s: number) => `Halve tick_s, to ${three_digits(tick_s)}, or lower max_speed_px_s.`,
  advise: (tick_s: number, speed_px_s: number) =>
    `Set tick_s to ${three_digits(tick_s)} or less, or max_speed_px_s to ${three_digits(speed_px_s)}.`,
};
