// What people read about undoing and redoing.
import {capitalised, with_separators} from "./numbers";

const counted = (count: number, one: string, many: string): string[] =>
  count === 0 ? [] : [`${with_separators(count)} ${count === 1 ? one : many}`];

export const undo_texts = {
  undo: "Undo",
  redo: "Redo",
  /** name: what is undone; empty: nothing can be. */
  undo_help: (name: string) => name === "" ? "There is nothing to undo." : `Undoes: ${name} (Ctrl+Z).`,
  redo_help: (name: string) => name === "" ? "There is nothing to redo." : `Does again: ${name} (Ctrl+Shift+Z).`,
  nothing_to_undo: "There is nothing to undo.",
  nothing_to_redo: "There is nothing to redo.",
  done: (name: string) => `${capitalised(name)}.`,
  not_last: (name: string) => `“${name}” is no longer the last change; Ctrl+Z undoes the changes one by one.`,
  busy: "The last change is still being undone or redone.",
  undone: (name: string) => `Undone: ${name}.`,
  redone: (name: string) => `Done again: ${name}.`,
  gone: (name: string) => `“${name}” was not undone, because nothing of it is left.`,
  /** What was placed: "placed 1 food, 2 organisms". */
  placed: (food: number, poison: number, organisms: number) => "placed " +
    [
      ...counted(food, "food", "food"), ...counted(poison, "poison", "poison"),
      ...counted(organisms, "organism", "organisms")
    ].join(", "),
  /** names: of the changed parameters. */
  parameters: (names: readonly string[]) =>
    names.length === 1 ? names[0]! : `${with_separators(names.length)} parameters`,
};
