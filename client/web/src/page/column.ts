// Column: the docked column: the summary of the shown world, and below it one panel, chosen by its tab.
import {column_texts} from "../texts/column";
import {h} from "../widgets/dom";
import type {Panel, PanelContext} from "../world/panel_context";
import type {Server} from "../world/server";
import {of_browser} from "../world/storage";
import {PanelTabs} from "./panel_tabs";
import {Summary} from "./summary";
import type {Tools} from "./tools";

const narrow = "(max-width: 800px)"; // there the description is hidden until the user opens it

export class Column {
  readonly element: HTMLElement;
  readonly panels: Panel[];
  readonly #summary: Summary;
  readonly #tabs: PanelTabs;

  constructor(context: PanelContext, server: Server, panels: Panel[], tools: Tools, head: HTMLElement[]) {
    this.panels = panels;
    this.#summary = new Summary(context, server, tools, head, !matchMedia(narrow).matches);
    this.#tabs = new PanelTabs(panels, (panel) => this.show(panel));
    this.element =
      h("aside", {class: "column", id: "column", "aria-label": column_texts.name}, this.#summary.element,
        this.#tabs.tabs, this.#tabs.body);
    const remembered = panels.find((panel) => panel.name === of_browser.get("panel"));
    this.show(remembered ?? panels[0]!);
  }

  /** The live fitness curve goes here. */
  get curve(): HTMLElement {
    return this.#summary.curve;
  }

  /** Shows a panel. */
  show(panel: Panel): void {
    if (panel === this.#tabs.shown) {
      return;
    }
    this.element.dataset.shown = panel.name; // tall panels hide the description in a low window
    of_browser.set("panel", panel.name);
    this.#tabs.show(panel);
    // If the column itself scrolls, the panel begins below the tabs. Narrow screens have too little room to show it
    // below the summary.
    const summary_px = this.#summary.element.offsetHeight;
    this.element.scrollTop = matchMedia(narrow).matches ? summary_px : Math.min(this.element.scrollTop, summary_px);
    panel.refresh();
  }

  refresh(): void {
    this.#summary.refresh();
    this.#tabs.shown?.refresh();
  }
}
