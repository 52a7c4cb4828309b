// LinkFollower: shows the moment that a link names, or the nearest one that the server has, and says what was wrong
// with the link.
import {app_texts} from "../texts/app";
import {wrong_link_texts as texts} from "../texts/start";
import {Refusal} from "../world/server";
import {nearest, read_link, within, type ReadLink} from "../world/link";
import type {Banner} from "../widgets/notices";
import type {PanelContext} from "../world/panel_context";
import type {Moment} from "../world/time_scale";
import type {ViewedWorld} from "../world/world";

const rate_max_hz = 60; // of servers that do not state it
const corrections_max = 2; // of the generation, then of the tick

export class LinkFollower {
  #wrong = "";
  #number = 0;

  /** on_change: called after banners() has changed. */
  readonly #context: PanelContext;
  readonly #on_change: () => void;

  constructor(context: PanelContext, on_change: () => void) {
    this.#context = context;
    this.#on_change = on_change;
  }

  banners(): Banner[] {
    const action = {label: app_texts.close, act: () => this.#say([])};
    return this.#wrong === "" ? [] : [{name: "link", kind: "warn", text: this.#wrong, actions: [action]}];
  }

  /** Shows what the link names in the pane with the focus. A later link ends an earlier one. */
  async follow(hash: string): Promise<void> {
    const read = read_link(hash);
    if (!read) {
      return;
    }
    const number = ++this.#number;
    try {
      await this.#show(read, () => number === this.#number);
    } catch (error) {
      read.wrong.push(error instanceof Error ? error.message : String(error));
    }
    if (number === this.#number) {
      this.#say(read.wrong);
    }
  }

  async #show(read: ReadLink, is_newest: () => boolean): Promise<void> {
    const {moment} = read, {server} = this.#context, world = this.#context.world();
    const name = moment.world ?? world.name, info = server.worlds.find(name);
    if (!info && server.worlds.damage_of(name)) {
      world.show(name);
      return;
    }
    if (!info) {
      const known = server.worlds.all.filter((one) => one.replay?.replay_of === undefined);
      read.wrong.unshift(texts.no_such_world(name, known.map((one) => one.name)));
      this.#context.open("worlds");
      return;
    }
    const rate_max = Math.floor(server.state.welcome?.limits?.snapshot_rate_hz_max ?? rate_max_hz);
    world.feed.set_rate(within(read, "rate", texts.this_server, 1, rate_max));
    const island = within(read, "island", texts.world(name), 0, (info.island_count ?? 1) - 1) ?? 0;
    if (moment.generation === null || world.name !== name) {
      world.show(name, island);
    } else {
      world.choose_island(island);
    }
    if (moment.generation !== null) {
      const {generation, tick} = moment;
      await this.#show_past(read, world, tick === null ? {generation} : {generation, tick}, is_newest);
      if (is_newest() && world.past.is_own_replay && world.control.state === "RUN_STATE_RUNNING") {
        await world.control.pause();
      }
    } else {
      await world.feed.drawn();
    }
    if (is_newest() && world.snapshot) {
      this.#select(read, world);
    }
  }

  /** Shows the moment, or the nearest one if the run has no such moment. */
  async #show_past(read: ReadLink, world: ViewedWorld, wanted: Moment, is_newest: () => boolean): Promise<void> {
    for (let corrections = 0; is_newest(); ++corrections) {
      try {
        return await world.past.show_moment(wanted);
      } catch (error) {
        const wrong = error instanceof Refusal && corrections < corrections_max ? error.violations[0] : undefined;
        const next = wrong && nearest(read, wanted, wrong.field, wrong.allowed);
        if (!next) {
          throw error;
        }
        wanted = next;
      }
    }
  }

  #select(read: ReadLink, world: ViewedWorld): void {
    const {snapshot} = world, {organism} = read.moment, wrong_before = read.wrong.length;
    const count = snapshot!.live?.organism_count ?? 0;
    if (organism === null) {
      world.selection.select(null);
      return;
    }
    if (count > 0) {
      within(read, "organism", texts.generation(snapshot!.generation), 0, count - 1);
    }
    if (read.wrong.length === wrong_before) {
      world.selection.select(organism);
      this.#context.open("organism");
    }
  }

  #say(wrong: string[]): void {
    this.#wrong = wrong.join("; ");
    this.#on_change();
  }
}
