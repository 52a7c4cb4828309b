// Summary: the top of the column: which world is shown, what its organisms try to do, warnings about its settings,
// what the marks mean, taking part, and run control.
import {column_texts as texts} from "../texts/column";
import {warning_text} from "../texts/parameters";
import {session_text} from "../texts/users";
import {set_options} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import type {PanelContext} from "../world/panel_context";
import type {Server} from "../world/server";
import {Legend} from "./legend";
import {RunBar} from "./run_bar";
import type {Tools} from "./tools";

export class Summary {
  readonly element: HTMLElement;
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
  readonly #warnings = h("p", {class: "warning lines", role: "status"});
  readonly #legend = new Legend();
  readonly #run_bar: RunBar;
  readonly #part: HTMLButtonElement;
  readonly #part_text = h("span", {class: "hint grow"});
  readonly #session = h("span", {class: "hint session", title: texts.session});

  /** head: further buttons at the top. */
  constructor(context: PanelContext, server: Server, tools: Tools, head: HTMLElement[]) {
    this.#context = context;
    this.#server = server;
    this.#tools = tools;
    this.#run_bar = new RunBar(context);
    const {access} = server;
    this.#part = h("button", {type: "button", onclick: () => access.set_taking_part(!access.taking_part)});
    this.element = h(
      "div", {class: "summary"},
      h("div", {class: "row column-head"}, h("span", {class: "label"}, texts.world), this.#world, this.#island,
        ...head),
      this.#experiment, this.#warnings, this.#legend.element,
      h("div", {class: "row part"}, this.#part, this.#part_text, this.#session), this.#run_bar.element, tools.element);
  }

  refresh(): void {
    this.#refresh_choices();
    const world = this.#context.world(), server = this.#server, {state, access: {taking_part}} = server;
    const is_damaged = server.worlds.damage_of(world.name) !== "";
    const state_text = is_damaged ? texts.is_damaged : world.name ? texts.loading : texts.none_open;
    set_text(this.#experiment, world.parameters.experiment || state_text);
    set_text(this.#warnings, world.parameters.set === null ? "" : warning_text(world.parameters.warnings));
    this.#legend.refresh(world);
    this.#run_bar.refresh();
    const {membership} = server.access;
    this.#part.hidden = !server.access.may_take_part || membership !== null;
    this.#part.className = taking_part ? "button" : "button button-primary";
    set_text(this.#part, taking_part ? texts.only_watch : texts.take_part);
    const part_text = state.phase !== "open" ? texts.no_connection :
      membership !== null                    ? texts.is_member(membership) :
      !server.access.may_take_part           ? texts.is_viewer :
      taking_part                            ? texts.takes_part :
                                               texts.watches(world.has_bodies);
    set_text(this.#part_text, part_text);
    set_text(this.#session, state.phase === "open" && membership === null ? session_text(state.welcome) : "");
    this.#tools.refresh(taking_part && world.has_bodies);
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
