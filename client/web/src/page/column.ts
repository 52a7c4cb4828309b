// Column: the docked column: the summary of the shown world, and below it one panel, chosen by its tab.
import {column_texts} from "../texts/column";
import {h} from "../widgets/dom";
import type {Panel, PanelContext} from "../world/panel_context";
import type {Server} from "../world/server";
import {of_browser} from "../world/storage";
import {PanelTabs} from "./panel_tabs";
import {Summary} from "./summary";
import type {Tools} from "./tools";

const stacked = "(max-width: 700px)"; // the column is below the world, and scrolls as a whole

export class Column {
  readonly element: HTMLElement;
  readonly panels: Panel[]; // without the overview
  readonly #summary: Summary;
  readonly #tabs: PanelTabs;
  readonly #overview: Panel;

  constructor(
    context: PanelContext, server: Server, overview: Panel, panels: Panel[], tools: Tools, head: HTMLElement[]) {
    this.panels = panels;
    this.#overview = overview;
    this.#summary = new Summary(context, server, tools, head);
    this.#tabs = new PanelTabs(overview, panels, (panel) => this.show(panel));
    this.element =
      h("aside", {class: "column", id: "column", "aria-label": column_texts.name}, this.#summary.element,
        this.#tabs.tabs, this.#tabs.body);
    this.#show(panels.find((panel) => panel.name === of_browser.get("panel")) ?? overview);
  }

  /** Shows a panel. */
  show(panel: Panel): void {
    if (panel === this.#tabs.shown) {
      return;
    }
    of_browser.set("panel", panel === this.#overview ? "" : panel.name);
    this.#show(panel);
    if (matchMedia(stacked).matches) { // else there is too little room to show it below the summary
      this.#tabs.tabs.scrollIntoView({block: "start"});
    }
  }

  refresh(): void {
    this.#summary.refresh();
    this.#tabs.shown?.refresh();
  }

  #show(panel: Panel): void {
    this.element.dataset.shown = panel.name;
    this.#tabs.show(panel);
    panel.refresh();
  }
}
