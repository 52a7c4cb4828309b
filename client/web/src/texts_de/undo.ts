// What people read about undoing and redoing.
import type * as english from "../texts/undo";

import {capitalised, with_separators} from "./numbers";

const counted = (count: number, one: string, many: string): string[] =>
  count === 0 ? [] : [`${with_separators(count)} ${count === 1 ? one : many}`];

export const undo_texts: typeof english.undo_texts = {
  undo: "Rückgängig",
  redo: "Wiederholen",
  undo_help: (name) => name === "" ? "Nichts ist rückgängig zu machen." : `Macht rückgängig: ${name} (Strg+Z).`,
  redo_help: (name) => name === "" ? "Nichts ist zu wiederholen." : `Wiederholt: ${name} (Strg+Umschalt+Z).`,
  nothing_to_undo: "Nichts ist rückgängig zu machen.",
  nothing_to_redo: "Nichts ist zu wiederholen.",
  done: (name) => `${capitalised(name)}.`,
  not_last: (name) => `„${name}“ ist nicht mehr die letzte Änderung; Strg+Z macht Änderungen nacheinander rückgängig.`,
  busy: "Die letzte Änderung wird noch rückgängig gemacht oder wiederholt.",
  undone: (name) => `Rückgängig gemacht: ${name}.`,
  redone: (name) => `Wiederholt: ${name}.`,
  gone: (name) => `„${name}“ wurde nicht rückgängig gemacht, weil nichts davon übrig ist.`,
  placed: (food, poison, organisms) => "eingesetzt: " +
    [
      ...counted(food, "Futter", "Futter"), ...counted(poison, "Gift", "Gift"),
      ...counted(organisms, "Organismus", "Organismen")
    ].join(", "),
  parameters: (names) => names.length === 1 ? names[0]! : `${with_separators(names.length)} Parameter`,
};
