// undo_command: undoes or repeats the last change of the user to the focused world, for keys and buttons.
import type {PanelContext} from "./panel_context";

export type UndoVerb = "undo"|"redo";

/** Why nothing can be undone or redone now, as a sentence; empty if it can. */
export function why_not_undo(context: PanelContext): string {
  return context.server.access.why_not("set_parameters", context.world().shown);
}

/** Undoes or redoes, and says what was done, or why nothing was. */
export async function undo(context: PanelContext, verb: UndoVerb): Promise<void> {
  const why = why_not_undo(context);
  if (why !== "") {
    context.notify(why, () => why_not_undo(context) === why);
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
