// Tools: what a click on the island does: select, place food, poison or a copy of an organism, or remove. Shown while
// the user takes part.
import {tool_buttons, tool_texts} from "../texts/pane";
import {guarded_button, set_allowed, set_attribute} from "../widgets/controls";
import {h} from "../widgets/dom";
import type {PanelContext} from "../world/panel_context";

import type {PaneTool} from "./pane_tool";
import {UndoButtons} from "./undo_buttons";

export class Tools {
  readonly element: HTMLElement;
  readonly #buttons: HTMLButtonElement[];
  readonly #tool: () => PaneTool;

  readonly #undo: UndoButtons;

  /** tool: of the focused pane. */
  constructor(context: PanelContext, tool: () => PaneTool) {
    const {notify} = context;
    this.#tool = tool;
    this.#undo = new UndoButtons(context);
    this.#buttons = tool_buttons.map(({tool: name, label}) => guarded_button(label, notify, () => tool().set(name)));
    this.element =
      h("div", {class: "row tools", role: "group", "aria-label": tool_texts.group}, h("span", {}, tool_texts.group),
        ...this.#buttons, this.#undo.element);
  }

  refresh(taking_part: boolean): void {
    const tool = this.#tool();
    this.element.hidden = !taking_part;
    this.#undo.refresh();
    if (tool.problem()) {
      tool.set("select");
    }
    tool_buttons.forEach(({tool: name, help}, i) => {
      set_allowed(this.#buttons[i]!, tool.problem(name), help);
      set_attribute(this.#buttons[i]!, "aria-pressed", String(tool.tool === name));
    });
  }
}
