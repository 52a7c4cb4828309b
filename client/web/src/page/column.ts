// Column: the docked column: what the organisms of the world try to do, what the marks mean, the healthiest organisms, the live
// fitness curve, run control, and the panels as tabs.
import {set_attribute, set_options} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {of_browser} from "../world/storage";

import {Legend} from "./legend";
import {RunBar} from "./run_bar";

import type {Server} from "../world/server";
import {session_text} from "../texts/texts";
import type {Tools} from "./tools";
import type {Panel, PanelContext} from "../world/panel_context";

const named = 3; // healthiest organisms
const narrow = "(max-width: 800px)";

export class Column {
  readonly element: HTMLElement;
  readonly panels: Panel[];
  /** The live fitness curve goes here. */
  readonly curve = h("div", {class: "curve"});

  #world: HTMLSelectElement =
    h("select", {class: "field", "aria-label": "World", onchange: () => this.#context.world().show(this.#world.value)});
  #island: HTMLSelectElement = h("select", {
    class: "field",
    "aria-label": "Island",
    onchange: () => this.#context.world().choose_island(Number(this.#island.value))
  });
  #experiment = h("p", {class: "experiment"});
  #legend = new Legend();
  #healthiest = h("p", {class: "healthiest"});
  #healthiest_label = h("span", {});
  #buttons: HTMLButtonElement[] = [];
  #run_bar: RunBar;
  #part: HTMLInputElement;
  #part_row: HTMLElement;
  #part_text = h("span", {class: "hint grow"});
  #session = h("span", {class: "hint session", title: "The user and the role of this session"});
  #tabs = h("div", {class: "tabs", role: "tablist", "aria-label": "Panels"});
  #body = h("div", {class: "panel-body"});
  #shown: Panel|null = null;
  #summary: HTMLElement;

  readonly #context: PanelContext;
  readonly #server: Server;
  readonly #tools: Tools;

  constructor(context: PanelContext, server: Server, panels: Panel[], tools: Tools, head: HTMLElement[]) {
    this.#context = context;
    this.#server = server;
    this.#tools = tools;
    this.panels = panels;
    this.#run_bar = new RunBar(context);
    this.#part =
      h("input", {type: "checkbox", role: "switch", onchange: () => server.set_taking_part(this.#part.checked)});
    this.#part_row =
      h("div", {class: "row part"}, h("label", {class: "check"}, this.#part, "Take part"), this.#part_text,
        this.#session);
    for (let i = 0; i < named; ++i) {
      this.#buttons.push(h("button", {type: "button", class: "link", onclick: () => this.#select_healthiest(i)}));
    }
    this.#healthiest.append(this.#healthiest_label, ...this.#buttons);
    const details =
      h("div", {class: "summary-details", id: "summary-details"}, this.#experiment, this.#legend.element,
        this.#healthiest, this.curve);
    const less: HTMLButtonElement = h("button", {
      type: "button",
      class: "button button-quiet square",
      "aria-controls": "summary-details",
      onclick: () => {
        of_browser.set("details", details.hidden ? "shown" : "hidden");
        this.#set_details(details.hidden, details, less);
      }
    });
    this.#summary =
      h("div", {class: "summary"},
        h("div", {class: "row column-head"}, h("span", {class: "label"}, "World"), this.#world, this.#island, less,
          ...head),
        details, this.#run_bar.element, this.#part_row, tools.element);
    this.element =
      h("aside", {class: "column", id: "column", "aria-label": "Controls and panels"}, this.#summary, this.#tabs,
        this.#body);
    const remembered =
      of_browser.get("details"); // on a narrow screen the description is hidden until the user opens it
    this.#set_details(remembered === "" ? !matchMedia(narrow).matches : remembered === "shown", details, less);
    panels.forEach((panel, i) => this.#add_tab(panel, i));
    const wanted = panels.find((panel) => panel.name === of_browser.get("panel"));
    this.show(wanted ?? panels[0]!);
  }

  get shown(): Panel {
    return this.#shown!;
  }

  /** Shows a panel. */
  show(panel: Panel): void {
    if (panel === this.#shown) {
      return;
    }
    this.#shown = panel;
    this.element.dataset.shown = panel.name; // tall panels hide the description in a low window
    of_browser.set("panel", panel.name);
    for (const one of this.panels) {
      const chosen = one === panel, tab = this.#tab_of(one);
      set_attribute(tab, "aria-selected", String(chosen));
      tab.tabIndex = chosen ? 0 : -1;
      one.element.hidden = !chosen;
    }
    this.#body.scrollTop = 0;
    // If the column itself scrolls, the panel begins below the tabs. Narrow screens have too little room to show it below the summary.
    const summary_px = this.#summary.offsetHeight;
    this.element.scrollTop = matchMedia(narrow).matches ? summary_px : Math.min(this.element.scrollTop, summary_px);
    panel.refresh();
  }

  refresh(): void {
    const world = this.#context.world(), server = this.#server;
    const listed = server.worlds.filter((one) => !one.replay || one.name === world.name),
          damaged = server.damage_of(world.name) !== "";
    const names = [
      ...listed.map((one) => ({value: one.name as string, text: one.name as string})),
      ...server.damaged.map((one) => ({value: one.name as string, text: `${one.name} (damaged)`}))
    ];
    set_options(this.#world, world.name ? names : [{value: "", text: "none"}, ...names], world.name);
    const islands: number = world.info?.island_count ?? world.snapshot?.island_count ?? 1;
    this.#island.hidden = islands < 2;
    set_options(
      this.#island, Array.from({length: islands}, (_, i) => ({value: String(i), text: `island ${i}`})),
      String(world.island));
    set_text(
      this.#experiment,
      world.parameters.experiment ||
        (damaged      ? "This world is damaged and does not run." :
           world.name ? "Loading the experiment …" :
                        "No world is open yet."));
    this.#legend.refresh(world);
    this.#buttons.forEach((button, i) => {
      const one = world.feed.healthiest[i];
      button.hidden = !one;
      set_text(button, one ? `#${one.id} (${Math.ceil(one.health)})` : "");
      set_attribute(button, "aria-pressed", String(one !== undefined && one.id === world.selection.id));
    });
    set_text(
      this.#healthiest_label,
      world.feed.healthiest.length > 0              ? "Healthiest now:" :
        !world.snapshot                             ? "" :
        (world.snapshot.live?.alive_count ?? 0) > 0 ? "Zoom in to see which organisms are the healthiest." :
                                                      "No organism is alive.");
    this.#run_bar.refresh();
    this.#part.checked = server.taking_part;
    this.#part.disabled = !server.may_take_part;
    set_text(this.#part_text, this.#part_sentence());
    set_text(this.#session, this.#server.state.phase === "open" ? session_text(this.#server.state.welcome) : "");
    this.#tools.refresh(server.taking_part);
    if (this.#shown) {
      this.#shown.refresh();
    }
  }

  #part_sentence(): string {
    if (this.#server.state.phase !== "open") {
      return "There is no connection.";
    }
    if (!this.#server.may_take_part) {
      return "You are a viewer: read-only.";
    }
    return this.#server.taking_part ? "Your changes act for everyone." : "You only watch until you turn it on.";
  }

  #select_healthiest(i: number): void {
    const one = this.#context.world().feed.healthiest[i];
    if (one) {
      this.#context.world().selection.select(one.id);
    }
  }

  #set_details(shown: boolean, details: HTMLElement, less: HTMLElement): void {
    details.hidden = !shown;
    set_text(less, shown ? "▴" : "▾");
    set_attribute(less, "aria-expanded", String(shown));
    const label = shown ? "Hide the description" : "Show the description";
    set_attribute(less, "aria-label", label);
    set_attribute(less, "title", label);
  }

  // ---- tabs: arrow keys move between them, as in the ARIA Authoring Practices ----

  #add_tab(panel: Panel, i: number): void {
    const tab =
      h("button", {
        type: "button",
        class: "tab",
        role: "tab",
        id: `tab-${i}`,
        "aria-controls": `panel-${i}`,
        title: i < 9 ? `Key ${i + 1}` : null,
        onclick: () => this.show(panel),
        onkeydown: (event: KeyboardEvent) => this.#move(event, i),
      },
        panel.title);
    this.#tabs.append(tab);
    panel.element.id = `panel-${i}`;
    panel.element.setAttribute("role", "tabpanel");
    panel.element.setAttribute("aria-labelledby", `tab-${i}`);
    panel.element.dataset.panel = panel.name;
    panel.element.hidden = true;
    this.#body.append(panel.element);
  }

  #tab_of(panel: Panel): HTMLElement {
    return this.#tabs.children[this.panels.indexOf(panel)] as HTMLElement;
  }

  #move(event: KeyboardEvent, i: number): void {
    const last = this.panels.length - 1;
    const to = event.key === "ArrowRight" || event.key === "ArrowDown" ? (i === last ? 0 : i + 1) :
      event.key === "ArrowLeft" || event.key === "ArrowUp"             ? (i === 0 ? last : i - 1) :
      event.key === "Home"                                             ? 0 :
      event.key === "End"                                              ? last :
                                                                         -1;
    if (to >= 0) {
      event.preventDefault();
      event.stopPropagation();
      this.show(this.panels[to]!);
      this.#tab_of(this.panels[to]!).focus();
    }
  }
}
