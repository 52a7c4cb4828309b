// Values and groups of parameters in words, and why a change was refused.
import type * as english from "../texts/parameter_words";

import {rounded, with_separators} from "./numbers";

export const parameter_words: typeof english.parameter_words = {
  most_used: "Am häufigsten benutzt",
  on: "ein",
  off: "aus",
  on_or_off: "ein oder aus",
  range: (min, max) => `${rounded(min)} bis ${rounded(max)}`,
  after_tick: (tick) => `nach Tick ${with_separators(tick)}`,
  in_generation: (generation) => `in Generation ${with_separators(generation)}`,
  see_marked: "Nichts wurde geändert: siehe die markierten Parameter",
  is_stale: "Gleichzeitig hat ein anderes Programm Parameter geändert: Werte prüfen und noch einmal anwenden",
  lost: "Es kam keine Antwort: Die Änderung kann wirksam sein oder nicht",
};
