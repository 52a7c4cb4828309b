// Summary: the top of the column: which world is shown, what its organisms try to do, what the marks mean, run control,
// and taking part.
import {column_texts as texts} from "../texts/column";
import {session_text} from "../texts/users";
import {set_attribute, set_options} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import type {PanelContext} from "../world/panel_context";
import type {Server} from "../world/server";
import {of_browser} from "../world/storage";
import {Legend} from "./legend";
import {RunBar} from "./run_bar";
import type {Tools} from "./tools";

export class Summary {
  readonly element: HTMLElement;
  /** Tall windows show the overview here. */
  readonly details: HTMLElement;

  readonly #context: PanelContext;
  readonly #server: Server;
  readonly #tools: Tools;
  readonly #world: HTMLSelectElement =
    h("select",
      {class: "field", "aria-label": texts.world, onchange: () => this.#context.world().show(this.#world.value)});
  readonly #island: HTMLSelectElement = h("select", {
    class: "field",
    "aria-label": texts.island,
    onchange: () => this.#context.world().choose_island(Number(this.#island.value))
  });
  readonly #experiment = h("p", {class: "experiment"});
  readonly #legend = new Legend();
  readonly #run_bar: RunBar;
  readonly #part: HTMLInputElement;
  readonly #part_text = h("span", {class: "hint grow"});
  readonly #session = h("span", {class: "hint session", title: texts.session});

  /** head: further buttons at the top. */
  constructor(context: PanelContext, server: Server, tools: Tools, head: HTMLElement[]) {
    this.#context = context;
    this.#server = server;
    this.#tools = tools;
    this.#run_bar = new RunBar(context);
    this.#part =
      h("input", {type: "checkbox", role: "switch", onchange: () => server.access.set_taking_part(this.#part.checked)});
    this.details = h("div", {class: "summary-details", id: "summary-details"}, this.#experiment, this.#legend.element);
    this.element =
      h("div", {class: "summary"},
        h("div", {class: "row column-head"}, h("span", {class: "label"}, texts.world), this.#world, this.#island,
          details_button(this.details), ...head),
        this.details, this.#run_bar.element,
        h("div", {class: "row part"}, h("label", {class: "check"}, this.#part, texts.take_part), this.#part_text,
          this.#session),
        tools.element);
  }

  refresh(): void {
    this.#refresh_choices();
    const world = this.#context.world(), server = this.#server, {state, access: {taking_part}} = server;
    const is_damaged = server.worlds.damage_of(world.name) !== "";
    const state_text = is_damaged ? texts.is_damaged : world.name ? texts.loading : texts.none_open;
    set_text(this.#experiment, world.parameters.experiment || state_text);
    this.#legend.refresh(world);
    this.#run_bar.refresh();
    this.#part.checked = taking_part;
    this.#part.disabled = !server.access.may_take_part;
    const part_text = state.phase !== "open" ? texts.no_connection :
      !server.access.may_take_part                  ? texts.is_viewer :
      taking_part                            ? texts.takes_part :
                                               texts.watches;
    set_text(this.#part_text, part_text);
    set_text(this.#session, state.phase === "open" ? session_text(state.welcome) : "");
    this.#tools.refresh(taking_part);
  }

  #refresh_choices(): void {
    const world = this.#context.world(), server = this.#server;
    const listed = server.worlds.all.filter((one) => !one.replay || one.name === world.name);
    const names = [
      ...listed.map(({name}) => ({value: name, text: name})),
      ...server.worlds.damaged.map(({name}) => ({value: name, text: texts.damaged(name)}))
    ];
    set_options(this.#world, world.name ? names : [{value: "", text: texts.no_world}, ...names], world.name);
    const islands = world.info?.island_count ?? world.snapshot?.island_count ?? 1;
    this.#island.hidden = islands < 2;
    set_options(
      this.#island, Array.from({length: islands}, (_, i) => ({value: String(i), text: texts.island_named(i)})),
      String(world.island));
  }
}

/** The button that hides or shows the description in a tall window. The browser remembers what the user has chosen. */
function details_button(details: HTMLElement): HTMLButtonElement {
  const button = h("button", {
    type: "button",
    class: "button button-quiet square tall-only",
    "aria-controls": details.id,
    onclick: () => {
      const is_shown = details.dataset.folded === "true";
      of_browser.set("details", is_shown ? "" : "hidden");
      set_shown(is_shown);
    }
  });
  const set_shown = (is_shown: boolean): void => {
    set_attribute(details, "data-folded", String(!is_shown));
    set_text(button, is_shown ? "▴" : "▾");
    set_attribute(button, "aria-expanded", String(is_shown));
    const label = is_shown ? texts.hide_description : texts.show_description;
    set_attribute(button, "aria-label", label);
    set_attribute(button, "title", label);
  };
  set_shown(of_browser.get("details") !== "hidden");
  return button;
}
