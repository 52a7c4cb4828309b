// IslandsTable: the islands of the shown world with their statistics. Asks for them while it is shown: events do not
// report the progress of a generation.
import type {Statistics} from "../core/protocol";
import {fitness_text, tenths} from "../texts/numbers";
import {worlds_texts as texts} from "../texts/worlds";
import {h, set_text} from "../widgets/dom";
import type {PanelContext} from "../world/panel_context";

import {table_head, type TableRow, update_rows} from "./rows";

const poll_ms = 1000;

export class IslandsTable {
  readonly element: HTMLElement;
  readonly #title = h("h3", {});
  readonly #rows = h("tbody", {});
  readonly #context: PanelContext;
  readonly #on_answer: () => void;
  #statistics: Statistics|null = null;
  #polled_ms = -Infinity;
  #pending = false;

  /** on_answer  called after the statistics and the list of worlds were read */
  constructor(context: PanelContext, on_answer: () => void) {
    this.#context = context;
    this.#on_answer = on_answer;
    const table =
      h("table", {class: "table", "aria-label": texts.island_table}, table_head(texts.island_headings, 1), this.#rows);
    this.element = h("div", {class: "panel"}, this.#title, table);
  }

  refresh(): void {
    const world = this.#context.world(), statistics = this.#statistics;
    const count = statistics?.world?.island_count ?? 0;
    this.element.hidden = count === 0 || statistics?.world?.name !== world.shown;
    if (statistics && !this.element.hidden) {
      set_text(this.#title, world.is_replay ? texts.islands_of_replay(world.name) : texts.islands(world.name));
      update_rows(this.#rows, Array.from({length: count}, (_, island) => this.#row(statistics, island)), 0);
    }
    this.#poll();
  }

  #row(statistics: Statistics, island: number): TableRow {
    const is_this = (one: {island?: number}): boolean => (one.island ?? 0) === island;
    const {island: shown, feed: {reading}} = this.#context.world();
    const live = (island === shown ? reading?.info.live : undefined) ?? statistics.live?.find(is_this);
    const last = statistics.last?.find(is_this);
    return {
      name: texts.island(island),
      chosen: island === shown,
      act: () => this.#context.world().choose_island(island),
      cells: [
        live ? texts.alive(live.alive_count ?? 0, live.organism_count ?? 0) : "",
        live ? tenths(live.health_mean ?? 0) : "", last ? fitness_text(last.fitness_best ?? 0) : ""
      ],
    };
  }

  #poll(): void {
    const {shown, server} = this.#context.world(), is_known = this.#statistics?.world?.name === shown;
    if (
      this.#pending || !shown || server.state.phase !== "open" ||
      (is_known && performance.now() < this.#polled_ms + poll_ms)) {
      return;
    }
    this.#pending = true;
    this.#polled_ms = performance.now();
    const statistics =
      server.request("get_statistics", {world: shown}).then((answer) => (this.#statistics = answer), () => undefined);
    void Promise.all([statistics, server.refresh_worlds()]).finally(() => {
      this.#pending = false;
      this.#on_answer();
    });
  }
}
