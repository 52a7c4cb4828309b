// PaneArea: a pane with its strips: above the canvas what is shown and how the world runs, below it the time line of a replay
// and the statistics of the island.
import {with_separators} from "../texts/numbers";
import {set_attribute} from "../widgets/controls";
import {h, set_text, svg} from "../widgets/dom";

import {Pane, type PaneOptions} from "./pane";
import {Timeline, type TimelineContext} from "./timeline";
import {place_and_speed_text, state_word, statistics_texts} from "../texts/texts";
import type {ViewedWorld} from "../world/world";

export class PaneArea {
  readonly element: HTMLElement;
  readonly pane: Pane;
  readonly timeline: Timeline;

  #generation = h("h1", {}, "");
  #replay = h("span", {class: "badge badge-replay", hidden: true});
  #place = h("span", {class: "pane-place"});
  #state = h("span", {class: "pane-state"});
  #beside = h("button", {type: "button", class: "button button-quiet square pane-beside"});
  #foot = h("div", {class: "strip pane-foot"});
  #message = h("p", {class: "pane-message", role: "status"});

  /** beside: shows a second world, or closes this pane if two are shown. */
  constructor(readonly world: ViewedWorld, options: Omit<PaneOptions, "world">&TimelineContext&{beside(): void}) {
    this.pane = new Pane({...options, world});
    this.timeline = new Timeline(world, options);
    this.#beside.addEventListener("click", () => options.beside());
    this.element =
      h("section", {class: "pane-area", "aria-label": "World"},
        h("div", {class: "strip pane-head"}, this.#generation, this.#replay, h("span", {class: "grow"}), this.#place,
          this.#state, this.#beside),
        h("div", {class: "pane-stage"}, this.pane.element, this.#message), this.timeline.element, this.#foot);
    this.set_beside(false);
    world.changes.listen(() => this.#refresh());
    this.#refresh();
  }

  /** Whether the pane is one of two. */
  set_beside(is_beside: boolean): void {
    const text = is_beside ? "Close this world" : "Show a second world beside (B)";
    if (this.#beside.title === text) {
      return;
    }
    set_attribute(this.#beside, "aria-label", text);
    set_attribute(this.#beside, "title", text);
    this.#beside.replaceChildren(
      is_beside ? "✕" :
                  svg(
                    "svg", {viewBox: "0 0 16 16", width: 16, height: 16, "aria-hidden": "true"},
                    svg("rect", {x: 1.5, y: 2.5, width: 13, height: 11, rx: 1.5, class: "beside-frame"}),
                    svg("path", {d: "M8 3v10", class: "beside-frame"})));
  }

  close(): void {
    this.timeline.close();
    this.pane.close();
    this.world.close();
    this.element.remove();
  }

  #refresh(): void {
    const world = this.world, snapshot = world.snapshot, info = world.info, server = world.server;
    const replay_of = info?.replay && (info.replay.replay_of || "a file");
    set_text(this.#generation, snapshot ? `Generation ${with_separators(snapshot.generation)}` : "");
    this.#replay.hidden = !replay_of;
    set_text(this.#replay, replay_of ? `REPLAY of ${replay_of}` : "");
    const running = world.control.state === "RUN_STATE_RUNNING";
    set_text(this.#place, snapshot ? place_and_speed_text(world.name, snapshot, world.control.speed, running) : world.name);
    const connected = server.state.phase === "open";
    const state = !connected ? "not connected" :
      snapshot || info       ? world.control.at_end ?
                               "end of the replay" :
                               state_word(world.control.state, info?.storage ?? server.storage, info?.awaited_fitness !== undefined) :
                               "";
    set_text(this.#state, state + (connected && running && info?.slowed ? " slower" : ""));
    set_attribute(this.#state, "data-state", connected && running ? "running" : "stopped");
    const texts = snapshot ? statistics_texts(snapshot) : [];
    while (this.#foot.children.length > texts.length) {
      this.#foot.lastElementChild!.remove();
    }
    texts.forEach((text, i) => set_text(this.#foot.children[i] ?? this.#foot.appendChild(h("span", {})), text));
    set_text(this.#message, world.feed.problem || (snapshot || !world.shown ? "" : "Waiting for the first snapshot …"));
    this.#message.hidden = this.#message.textContent === "";
    set_attribute(
      this.element, "aria-label", world.name ? `World ${world.name}${world.is_replay ? ", replay" : ""}` : "World");
  }
}
