// UndoButtons: undo and redo of the changes of this page to the focused world, next to the tools.
import {undo_texts} from "../texts/undo";
import {guarded_button, set_allowed, set_attribute} from "../widgets/controls";
import {h, svg} from "../widgets/dom";
import type {PanelContext} from "../world/panel_context";
import {undo} from "../world/undo_command";

const arrow = "M6 3L2.5 6.5L6 10M2.5 6.5h7a4 4 0 0 1 0 8H7";

export class UndoButtons {
  readonly element: HTMLElement;
  readonly #context: PanelContext;
  readonly #undo: HTMLButtonElement;
  readonly #redo: HTMLButtonElement;

  constructor(context: PanelContext) {
    this.#context = context;
    const button = (verb: "undo"|"redo", classes: string): HTMLButtonElement => {
      const made = guarded_button("", context.notify, () => void undo(context, verb), `button square ${classes}`);
      made.replaceChildren(svg(
        "svg", {viewBox: "0 0 16 16", width: 16, height: 16, "aria-hidden": "true"},
        svg("path", {d: arrow, class: "pane-icon"})));
      set_attribute(made, "aria-label", undo_texts[verb]);
      return made;
    };
    this.#undo = button("undo", "undo");
    this.#redo = button("redo", "undo redo");
    this.element = h("div", {class: "undo-buttons"}, this.#undo, this.#redo);
  }

  refresh(): void {
    const history = this.#context.world().undo, {next_undo, next_redo} = history;
    set_allowed(this.#undo, next_undo === "" ? undo_texts.nothing_to_undo : "", undo_texts.undo_help(next_undo));
    set_allowed(this.#redo, next_redo === "" ? undo_texts.nothing_to_redo : "", undo_texts.redo_help(next_redo));
  }
}
