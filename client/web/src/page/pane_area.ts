// PaneArea: a pane with its strips: above the canvas what is shown and how the world runs, below it the time line of a
// replay and the statistics of the island.
import {access_texts} from "../texts/access";
import {link_texts, pane_texts, tile_texts} from "../texts/pane";
import {place_and_speed_text, statistics_texts} from "../texts/snapshot";
import {state_word} from "../texts/states";
import {guarded_button, set_allowed, set_attribute} from "../widgets/controls";
import {h, set_text, svg} from "../widgets/dom";
import type {Notify} from "../widgets/notices";
import type {ViewedWorld} from "../world/world";
import {Pane, type PaneOptions} from "./pane";
import {Timeline, type TimelineContext} from "./timeline";

export interface PaneAreaOptions extends Omit<PaneOptions, "world">, TimelineContext {
  /** Shows a second world, or closes this pane if two are shown. */
  beside(): void;
  /** Links the views of two worlds, or unlinks them. */
  link(): void;
}

const narrow = 520; // CSS pixels: without room for the ticks per second

function icon(...shapes: SVGElement[]): SVGElement {
  return svg("svg", {viewBox: "0 0 16 16", width: 16, height: 16, "aria-hidden": "true"}, ...shapes);
}

function icon_button(name: string, ...content: (SVGElement|string)[]): HTMLButtonElement {
  const classes = `button button-quiet square pane-button ${name}`;
  return h("button", {type: "button", class: classes}, ...content);
}

export class PaneArea {
  readonly element: HTMLElement;
  readonly pane: Pane;
  readonly timeline: Timeline;

  readonly #generation = h("h1", {}, "");
  readonly #replay = h("span", {class: "badge badge-replay", hidden: true});
  readonly #place = h("span", {class: "pane-place"});
  readonly #state = h("span", {class: "pane-state"});
  readonly #islands: HTMLButtonElement;
  readonly #link = icon_button(
    "pane-link",
    icon(svg(
      "path", {d: "M6.5 9.5l3-3M7 5l2-2a2.8 2.8 0 0 1 4 4l-2 2M9 11l-2 2a2.8 2.8 0 0 1-4-4l2-2", class: "pane-icon"})));
  readonly #beside = icon_button("pane-beside");
  readonly #foot = h("div", {class: "strip pane-foot"});
  readonly #start: HTMLButtonElement; // of a world that waits
  readonly #message = h("p", {class: "pane-message", role: "status"});
  readonly #caption = h("p", {class: "pane-caption", hidden: true});

  constructor(readonly world: ViewedWorld, options: PaneAreaOptions) {
    this.pane = new Pane({...options, world});
    this.timeline = new Timeline(world, options);
    this.#islands = guarded_button(tile_texts.show, options.notify, () => this.toggle_tiles(options.notify));
    this.#islands.className = "button button-quiet pane-islands";
    this.#islands.replaceChildren(
      icon(svg("path", {d: "M2 2h5v5H2zM9 2h5v5H9zM2 9h5v5H2zM9 9h5v5H9z", class: "pane-icon"})),
      h("span", {}, tile_texts.show));
    set_attribute(this.#islands, "aria-label", tile_texts.show);
    set_attribute(this.#link, "aria-label", link_texts.name);
    this.#link.addEventListener("click", () => options.link());
    this.#beside.addEventListener("click", () => options.beside());
    const start = (): void => {
      world.server.access.set_taking_part(true);
      void options.attempt(() => world.control.run());
    };
    this.#start =
      h("button",
        {type: "button", class: "button button-primary pane-start", title: pane_texts.start_help, onclick: start},
        pane_texts.start);
    this.element =
      h("section", {class: "pane-area", "aria-label": pane_texts.world},
        h("div", {class: "strip pane-head"}, this.#generation, this.#replay, h("span", {class: "grow"}), this.#place,
          this.#state, this.#islands, this.#link, this.#beside),
        this.#caption, h("div", {class: "pane-stage"}, this.pane.element, this.#message, this.#start),
        this.timeline.element, this.#foot);
    this.set_beside(false, false);
    world.changes.listen(() => this.#refresh());
    this.#refresh();
  }

  /** Shows all islands as tiles, or only the chosen one. */
  toggle_tiles(notify: Notify): void {
    const problem = this.pane.tiles.toggle();
    if (problem !== "") {
      notify(problem, () => this.pane.tiles.problem === problem);
    }
    this.#refresh();
  }

  /** A sentence above the island; empty: none. */
  set_caption(text: string): void {
    set_text(this.#caption, text);
    this.#caption.hidden = text === "";
  }

  /** are_two: whether the pane is one of two; are_linked: whether both move together. */
  set_beside(are_two: boolean, are_linked: boolean): void {
    this.#link.hidden = !are_two;
    set_attribute(this.#link, "aria-pressed", String(are_linked));
    set_attribute(this.#link, "title", `${link_texts.name}. ${are_linked ? link_texts.linked : link_texts.help}`);
    const text = are_two ? pane_texts.close : pane_texts.beside;
    if (this.#beside.title === text) {
      return;
    }
    set_attribute(this.#beside, "aria-label", text);
    set_attribute(this.#beside, "title", text);
    const frame = svg("rect", {x: 1.5, y: 2.5, width: 13, height: 11, rx: 1.5, class: "pane-icon"});
    this.#beside.replaceChildren(are_two ? "✕" : icon(frame, svg("path", {d: "M8 3v10", class: "pane-icon"})));
  }

  close(): void {
    this.timeline.close();
    this.pane.close();
    this.world.close();
    this.element.remove();
  }

  #refresh(): void {
    const world = this.world, {snapshot, info, server} = world;
    const replay_of = info?.replay && (info.replay.replay_of || pane_texts.a_file);
    set_text(this.#generation, snapshot ? pane_texts.generation(snapshot.generation, world.has_births) : "");
    this.#replay.hidden = !replay_of;
    set_text(this.#replay, replay_of ? pane_texts.replay_of(replay_of) : "");
    const is_running = world.control.state === "RUN_STATE_RUNNING", with_rate = this.pane.view.size.width > narrow;
    const place = snapshot && place_and_speed_text(world.name, snapshot, world.control.speed, is_running && with_rate);
    set_text(this.#place, place ?? world.name);
    const is_connected = server.state.phase === "open", is_silent = server.state.silent_s > 0;
    const runs_now = is_connected && is_running && !is_silent && !info?.frozen;
    set_text(this.#state, this.#state_text() + (runs_now && info?.slowed ? pane_texts.slower : ""));
    set_attribute(this.#state, "data-state", runs_now ? "running" : "stopped");
    this.#refresh_islands();
    const {reading, drawing} = world.feed;
    const texts = reading === null ?
      [] :
      statistics_texts(reading.info, world.has_bodies, world.has_births, drawing?.predators);
    while (this.#foot.children.length > texts.length) {
      this.#foot.lastElementChild!.remove();
    }
    texts.forEach((text, i) => set_text(this.#foot.children[i] ?? this.#foot.appendChild(h("span", {})), text));
    const may_run =
      ["", access_texts.watching, access_texts.no_connection].includes(server.access.why_not("run", world.shown));
    this.#start.hidden = world.is_replay || world.control.state !== "RUN_STATE_WAITING" || !may_run;
    const is_waiting = !snapshot && world.shown !== "" && !this.pane.tiles.is_on;
    set_text(this.#message, world.feed.problem || (is_waiting ? pane_texts.waiting : ""));
    this.#message.hidden = this.#message.textContent === "";
    set_attribute(
      this.element, "aria-label", world.name ? pane_texts.world_named(world.name, world.is_replay) : pane_texts.world);
  }

  #state_text(): string {
    const {info, server, snapshot, control: {at_end, state}} = this.world;
    if (server.state.phase !== "open") {
      return pane_texts.not_connected;
    }
    if (!snapshot && !info) {
      return "";
    }
    if (info?.frozen) {
      return pane_texts.frozen;
    }
    if (state === "RUN_STATE_RUNNING" && server.state.silent_s > 0) {
      return pane_texts.silent(server.state.silent_s);
    }
    return at_end ? pane_texts.end_of_replay :
                    state_word(state, info?.storage ?? server.storage, info?.awaited_fitness !== undefined);
  }

  #refresh_islands(): void {
    const {tiles} = this.pane, {island} = this.world;
    this.#islands.hidden = tiles.island_count < 2 || !this.world.has_bodies;
    set_attribute(this.#islands, "aria-pressed", String(tiles.is_on));
    const help = tiles.is_on ? tile_texts.hide_help(island) :
      tiles.can_return       ? tile_texts.back_help :
                               tile_texts.show_help(tiles.island_count);
    set_allowed(this.#islands, tiles.problem, help);
  }
}
