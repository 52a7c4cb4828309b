// Tools: what a click on the island does: select, place food, poison or a copy of an organism, or remove. Shown while the user
// takes part.
import type {Tool} from "../core/messages";
import {guarded_button, set_allowed, set_attribute} from "../widgets/controls";
import {h} from "../widgets/dom";
import type {Pane} from "./pane";

const tools: [Tool, string, string][] = [
  ["select", "Select", "A click in the island selects the organism there (Esc)."],
  ["food", "Food", "A click in the island places food. It does not reappear when it is eaten."],
  ["poison", "Poison", "A click in the island places poison. It does not reappear when it is eaten."],
  ["organism", "Organism", "A click in the island places a copy of the selected organism."],
  ["remove", "Remove", "A click in the island removes the organism, food or poison there until the generation ends."],
];

export class Tools {
  readonly element: HTMLElement;
  #buttons: HTMLButtonElement[];

  readonly #pane: () => Pane;

  constructor(pane: () => Pane, notify: (text: string) => void) {
    this.#pane = pane;
    this.#buttons = tools.map(([tool, label]) => guarded_button(label, notify, () => pane().set_tool(tool)));
    this.element =
      h("div", {class: "row tools", role: "group", "aria-label": "Click"}, h("span", {}, "Click"), ...this.#buttons);
  }

  refresh(taking_part: boolean): void {
    const pane = this.#pane();
    this.element.hidden = !taking_part;
    if (pane.tool !== "select" && pane.tool_problem(pane.tool)) {
      pane.set_tool("select");
    }
    tools.forEach(([tool, , help], i) => {
      set_allowed(this.#buttons[i]!, pane.tool_problem(tool), help);
      set_attribute(this.#buttons[i]!, "aria-pressed", String(pane.tool === tool));
    });
  }
}
