// UndoHistory: the changes of this page to one world, newest last, and those that were undone. Pure: no DOM.
import {undo_texts} from "../texts/undo";

const steps_kept = 100;

/** A change that can be undone, and then done again. */
export interface UndoStep {
  readonly name: string; // what the change was: "placed food"
  /** Whether undoing still has a meaning. A step without one is forgotten. */
  can_undo(): boolean;
  can_redo(): boolean;
  /** Resolves with whether anything was undone; if not, the step is forgotten. Rejects if it may succeed later. */
  undo(): Promise<boolean>;
  redo(): Promise<boolean>;
}

export class UndoHistory {
  #done: UndoStep[] = [];
  #undone: UndoStep[] = [];
  #is_busy = false; // a step is being undone or redone
  readonly #on_change: () => void;

  constructor(on_change: () => void) {
    this.#on_change = on_change;
  }

  /** Adds a change that the user has made. What was undone before cannot be redone any more. */
  add(step: UndoStep): void {
    this.#undone = [];
    this.#keep(this.#done, step);
  }

  /** The name of the change that undo() reverses; empty: none. */
  get next_undo(): string {
    this.#done = this.#done.filter((step) => step.can_undo());
    return this.#done.at(-1)?.name ?? "";
  }

  get next_redo(): string {
    this.#undone = this.#undone.filter((step) => step.can_redo());
    return this.#undone.at(-1)?.name ?? "";
  }

  /** Reverses the last change. Resolves with a sentence about what was done, or why nothing was. */
  undo(): Promise<string> {
    return this.next_undo === "" ? Promise.resolve(undo_texts.nothing_to_undo) :
                                   this.#move(this.#done, () => this.#undone, "undo", undo_texts.undone);
  }

  /** Repeats the change that was undone last. */
  redo(): Promise<string> {
    return this.next_redo === "" ? Promise.resolve(undo_texts.nothing_to_redo) :
                                   this.#move(this.#undone, () => this.#done, "redo", undo_texts.redone);
  }

  async #move(from: UndoStep[], to: () => UndoStep[], verb: "undo"|"redo", text: (name: string) => string):
    Promise<string> {
    if (this.#is_busy) {
      return undo_texts.busy;
    }
    this.#is_busy = true;
    const step = from.pop()!;
    try {
      if (!await step[verb]()) {
        return undo_texts.gone(step.name);
      }
      this.#keep(to(), step);
      return text(step.name);
    } catch (error) {
      from.push(step);
      throw error;
    } finally {
      this.#is_busy = false;
      this.#on_change();
    }
  }

  #keep(list: UndoStep[], step: UndoStep): void {
    list.push(step);
    if (list.length > steps_kept) {
      list.shift();
    }
    this.#on_change();
  }
}
