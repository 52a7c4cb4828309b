// physics: the panel "Physics": how the bodies of an island move, and whether a tick is short enough for them.
import type * as english from "../texts/physics";

import {shown_number, significant, three_digits, with_separators, with_unit} from "./numbers";

export const physics_texts: typeof english.physics_texts = {
  title: "Physik",
  tick: "Tick",
  waiting: "Warten auf die ersten Zahlen …",
  none: "noch keine Zahlen",
  now: (name, value, unit) => `${name}: ${with_unit(Number(value.toPrecision(6)), unit)}`,
  with_unit: (name, unit) => (unit === "" ? name : `${name}, ${unit}`),
  kinetic_energy: "kinetische Energie",
  energy_unit: "kg px²/s²",
  momentum: "Impuls aller Körper zusammen",
  momentum_unit: "kg px/s",
  touching: "Paare von Körpern, die sich berühren",
  overlap: "tiefste Überlappung",
  fastest: "schnellster Körper",
  movement: "Weg des schnellsten je Tick",
  px: "px",
  px_s: "px/s",
  radii: "seines Radius",

  bodies: (bodies, pairs, tick_s) =>
    `${with_separators(bodies)} Körper (Organismen und Kisten), ${with_separators(pairs)} ${
      pairs === 1 ? "Paar berührt" : "Paare berühren"} sich; ein Tick von ${shown_number(tick_s)} s.`,
  details: (step_px, strip_px, overlap_share) => `Der schnellste Körper bewegt sich in einem Tick um ${
                                                   significant(step_px)} px; die Suche nach Berührungen benutzt ` +
    `Streifen von ${shown_number(strip_px)} px. Die tiefste Überlappung beträgt ${
                                                   significant(overlap_share)} des Radius des kleineren Körpers.`,
  counts: (too_fast, limited) =>
    `In dieser Generation ${too_fast === 1 ? "war" : "waren"} ${with_separators(too_fast)} ${
      too_fast === 1 ? "Bewegung" :
                       "Bewegungen"} länger als der Radius des Körpers, und die Höchstgeschwindigkeit begrenzte ` +
    `${with_separators(limited)}-mal das Tempo eines Körpers.`,
  integrators:
    "Wie weit Positionen von der Länge eines Ticks abhängen: `evod check --integrators` bewegt einen Körper " +
    "mit beiden Integratoren des Servers und vergleicht die Positionen mit der exakten Lösung.",

  short_enough: (movement) => `Der Tick ist kurz genug: Der schnellste Körper bewegt sich in einem Tick um ${
    significant(movement)} seines Radius.`,
  short_enough_for_most: (finding) => `Der Tick ist kurz genug: Nur ${finding}`,
  nearly_too_long: (finding, advice) => `Der Tick ist fast zu lang: ${finding} ${advice}`,
  too_long: (finding, advice) => `Der Tick ist zu lang: ${finding} ${advice}`,
  finding: (bodies, of) => `im Mittel ${significant(bodies)} von ${
                             with_separators(of)} Körpern bewegen sich in einem Tick dieser Generation ` +
    "weiter als ihr Radius. Zwei solche Körper, die sich begegnen, können durcheinander hindurchgehen.",
  advise_half: (tick_s) => `Den Tick auf ${three_digits(tick_s)} s halbieren oder die Höchstgeschwindigkeit senken.`,
  advise: (tick_s, speed_px_s) => `Den Tick auf höchstens ${
    three_digits(tick_s)} s setzen oder die Höchstgeschwindigkeit auf ${three_digits(speed_px_s)}.`,
};
