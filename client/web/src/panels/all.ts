// The panels of the column, in the order of their tabs.
import {panels_texts, panels_texts as texts} from "../texts/panels";
import {h} from "../widgets/dom";
import type {Panel, PanelContext} from "../world/panel_context";
import {EventsPanel} from "./events";
import {ParametersPanel} from "./parameters";
import {RunPanel} from "./run";
import {ViewPanel} from "./view";
import {WorldsPanel} from "./worlds";

/** A panel whose code is loaded when it is first shown, so that the page itself loads faster. */
export class LazyPanel implements Panel {
  readonly element = h("div", {class: "lazy-panel"});
  #panel: Panel|null = null;
  #loading = false;
  #subject: {[key: string]: unknown}|null = null; // of a show() before the code was loaded

  constructor(readonly name: string, readonly title: string, readonly load: () => Promise<Panel>) {}

  refresh(): void {
    if (this.#panel) {
      this.#panel.refresh();
    } else if (!this.#loading) {
      this.#loading = true;
      this.element.textContent = panels_texts.loading;
      this.load().then((panel) => this.#show_loaded(panel), (error) => {
        this.#loading = false; // the next refresh() tries again
        this.element.textContent = panels_texts.not_loaded(error instanceof Error ? error.message : String(error));
      });
    }
  }

  show(subject: {[key: string]: unknown}): void {
    if (this.#panel) {
      this.#panel.show?.(subject);
    } else {
      this.#subject = subject;
    }
  }

  #show_loaded(panel: Panel): void {
    this.#panel = panel;
    this.element.replaceChildren(panel.element);
    panel.refresh();
    if (this.#subject) {
      panel.show?.(this.#subject);
    }
  }
}

type Later = typeof import("./loaded_later");

/** A panel whose code is in panels.js. */
function later(name: string, title: string, make: (loaded: Later, context: PanelContext) => Panel):
  (context: PanelContext) => Panel {
  return (context) => new LazyPanel(name, title, async () => make(await import("./loaded_later"), context));
}

export const panels: ((context: PanelContext) => Panel)[] = [
  (context) => new WorldsPanel(context),
  (context) => new RunPanel(context),
  (context) => new ParametersPanel(context),
  (context) => new ViewPanel(context),
  later("organism", texts.organism, ({OrganismPanel}, context) => new OrganismPanel(context)),
  later("glass box", texts.glass_box, ({GlassBoxPanel}, context) => new GlassBoxPanel(context)),
  later("family", texts.family, ({FamilyPanel}, context) => new FamilyPanel(context)),
  later("plots", texts.plots, ({PlotsPanel}, context) => new PlotsPanel(context)),
  (context) => new EventsPanel(context),
  later("freezer", texts.freezer, ({FreezerPanel}, context) => new FreezerPanel(context)),
  later("physics", texts.physics, ({PhysicsPanel}, context) => new PhysicsPanel(context)),
];
