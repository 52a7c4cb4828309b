// PanelTabs: the panels of the column, one at a time, and their tabs. Arrow keys move between the tabs, as in the ARIA
// Authoring Practices.
import {column_texts} from "../texts/column";
import {set_attribute} from "../widgets/controls";
import {h} from "../widgets/dom";
import type {Panel} from "../world/panel_context";

const keys_max = 9; // panels that have a key

export class PanelTabs {
  readonly tabs = h("div", {class: "tabs", role: "tablist", "aria-label": column_texts.panels});
  readonly body = h("div", {class: "panel-body"});
  #shown: Panel|null = null;
  readonly #panels: readonly Panel[];
  readonly #show: (panel: Panel) => void;

  /** first: has no key; show: called when the user chooses a panel. */
  constructor(first: Panel, panels: readonly Panel[], show: (panel: Panel) => void) {
    this.#panels = [first, ...panels];
    this.#show = show;
    this.#panels.forEach((panel, i) => this.#add(panel, i));
  }

  get shown(): Panel|null {
    return this.#shown;
  }

  show(panel: Panel): void {
    this.#shown = panel;
    for (const one of this.#panels) {
      const is_shown = one === panel, tab = this.#tab_of(one);
      set_attribute(tab, "aria-selected", String(is_shown));
      tab.tabIndex = is_shown ? 0 : -1;
      one.element.hidden = !is_shown;
    }
    this.body.scrollTop = 0;
  }

  #add(panel: Panel, i: number): void {
    this.tabs.append(
      h("button", {
        type: "button",
        class: "tab",
        role: "tab",
        id: `tab-${i}`,
        "aria-controls": `panel-${i}`,
        title: i > 0 && i <= keys_max ? column_texts.key(i) : null,
        onclick: () => this.#show(panel),
        onkeydown: (event: KeyboardEvent) => this.#move(event, i),
      },
        panel.title));
    panel.element.id = `panel-${i}`;
    panel.element.setAttribute("role", "tabpanel");
    panel.element.setAttribute("aria-labelledby", `tab-${i}`);
    panel.element.dataset.panel = panel.name;
    panel.element.hidden = true;
    this.body.append(panel.element);
  }

  #tab_of(panel: Panel): HTMLElement {
    return this.tabs.children[this.#panels.indexOf(panel)] as HTMLElement;
  }

  #move(event: KeyboardEvent, i: number): void {
    const last = this.#panels.length - 1;
    const to = event.key === "ArrowRight" || event.key === "ArrowDown" ? (i === last ? 0 : i + 1) :
      event.key === "ArrowLeft" || event.key === "ArrowUp"             ? (i === 0 ? last : i - 1) :
      event.key === "Home"                                             ? 0 :
      event.key === "End"                                              ? last :
                                                                         -1;
    const panel = this.#panels[to];
    if (panel !== undefined) {
      event.preventDefault();
      event.stopPropagation();
      this.#show(panel);
      this.#tab_of(panel).focus();
    }
  }
}
