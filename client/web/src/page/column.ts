// Column: the docked column: the summary of the shown world, and below it one panel, chosen by its tab.
import {column_texts} from "../texts/column";
import {h} from "../widgets/dom";
import type {Panel, PanelContext} from "../world/panel_context";
import type {Server} from "../world/server";
import {of_browser} from "../world/storage";
import type {Overview} from "./overview";
import {PanelTabs} from "./panel_tabs";
import {Summary} from "./summary";
import type {Tools} from "./tools";

/** Windows with room for the overview above a panel; app.css has the same sizes. */
const tall = "(min-height: 900px) and (min-width: 701px)";
const stacked = "(max-width: 700px)"; // the column is below the world, and scrolls as a whole

export class Column {
  readonly element: HTMLElement;
  readonly panels: Panel[]; // without the overview
  readonly #overview: Overview;
  readonly #summary: Summary;
  readonly #tabs: PanelTabs;
  readonly #tall = matchMedia(tall);

  constructor(
    context: PanelContext, server: Server, overview: Overview, panels: Panel[], tools: Tools, head: HTMLElement[]) {
    this.panels = panels;
    this.#overview = overview;
    this.#summary = new Summary(context, server, tools, head);
    this.#tabs = new PanelTabs(overview, panels, (panel) => this.show(panel));
    this.element =
      h("aside", {class: "column", id: "column", "aria-label": column_texts.name}, this.#summary.element,
        this.#tabs.tabs, this.#tabs.body);
    this.#tall.addEventListener("change", () => this.#place_overview());
    this.#place_overview();
    const remembered = panels.find((panel) => panel.name === of_browser.get("panel"));
    this.#show(remembered ?? this.#first);
  }

  /** Shows a panel. */
  show(panel: Panel): void {
    if (panel === this.#tabs.shown) {
      return;
    }
    of_browser.set("panel", panel === this.#first ? "" : panel.name);
    this.#show(panel);
    if (matchMedia(stacked).matches) { // else there is too little room to show it below the summary
      this.#tabs.tabs.scrollIntoView({block: "start"});
    }
  }

  refresh(): void {
    this.#summary.refresh();
    if (this.#tall.matches) {
      this.#overview.refresh();
    }
    this.#tabs.shown?.refresh();
  }

  get #first(): Panel {
    return this.#tall.matches ? this.panels[0]! : this.#overview;
  }

  #show(panel: Panel): void {
    this.element.dataset.shown = panel.name;
    this.#tabs.show(panel);
    panel.refresh();
  }

  #place_overview(): void {
    const is_tall = this.#tall.matches, is_shown = this.#tabs.shown === this.#overview;
    this.#tabs.set_first(!is_tall);
    if (is_tall) {
      this.#overview.element.hidden = false;
      this.#summary.details.append(this.#overview.element);
      if (is_shown) {
        this.#show(this.#first);
      }
    } else {
      this.#overview.element.hidden = !is_shown;
      this.#tabs.body.prepend(this.#overview.element);
    }
    this.#overview.refresh();
  }
}
