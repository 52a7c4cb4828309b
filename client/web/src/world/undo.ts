// UndoHistory: the changes of this page to one world, newest last, and those that were undone; and the command that
// undoes or repeats the last change of the focused world, for keys and buttons.
import {undo_texts} from "../texts/undo";
import type {PanelContext} from "./panel_context";

export type UndoVerb = "undo"|"redo";

/** Why nothing can be undone or redone now, as a sentence; empty if it can. */
export function why_not_undo(context: PanelContext): string {
  return context.server.why_not("set_parameters", context.world().shown);
}

/** Undoes or redoes, and says what was done, or why nothing was. */
export async function undo(context: PanelContext, verb: UndoVerb): Promise<void> {
  const why = why_not_undo(context);
  if (why !== "") {
    context.notify(why);
    return;
  }
  await context.attempt(async () => context.notify(await context.world().undo[verb]()));
}

/** What a key does to the last change; null: nothing. Ctrl+Z undoes, Ctrl+Shift+Z and Ctrl+Y redo; a text field undoes
 *  its own text. */
export function undo_verb_of(event: KeyboardEvent): UndoVerb|null {
  const key = event.key.toLowerCase(), {target} = event;
  if (!(event.ctrlKey || event.metaKey) || event.altKey || (key !== "z" && key !== "y")) {
    return null;
  }
  const has_text = target instanceof HTMLInputElement ? !/^(range|checkbox|radio|button|color)$/.test(target.type) :
    target instanceof Element                         ? target.closest("textarea, [contenteditable]") !== null :
                                                        false;
  return has_text ? null : key === "y" || event.shiftKey ? "redo" : "undo";
}

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
