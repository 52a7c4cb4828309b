// OtherHistory: the history of a world that no pane shows, for a comparison. It follows the world while it runs.
import {marks_of} from "./change_marks";
import {HistoryTable} from "./history_table";

import type {Mark} from "./plot_layout";
import type {Server} from "../world/server";
import {kind_of, none_left} from "../core/messages";
import type {AppliedChange, Event, GenerationStatistics} from "../core/protocol";

const missed_wait_ms = 1000; // after the server has dropped events
const generations_kept_default = 10_000;

export class OtherHistory {
  readonly table = new HistoryTable();
  changes: (Mark&{label?: string})[] = [];
  problem = ""; // why the history is not complete
  #end: () => void;
  #timer = 0;
  #number = 0; // of the last reading
  #newer: GenerationStatistics[]|null =
    null; // statistics that arrived while the history is read; null: it is not being read

  /** on_change: called after each change. */
  readonly #server: Server;
  readonly #on_change: () => void;

  constructor(server: Server, readonly world: string, on_change: () => void) {
    this.#server = server;
    this.#on_change = on_change;
    this.#end = server.on_event((event) => this.#take(event));
    void this.#read();
  }

  get gene_names(): string[] {
    return this.#server.world(this.world)?.gene_names ?? [];
  }

  close(): void {
    this.#number += 1;
    clearTimeout(this.#timer);
    this.#end();
  }

  #take(event: Event): void {
    const of = kind_of(event);
    if (of === null || (event.world !== this.world && of.kind !== "events_dropped")) {
      return;
    }
    switch (of.kind) {
      case "events_dropped":
        this.#read_later();
        break;
      case "world_reset":
      case "world_created":
      case "parameters_changed":
        void this.#read();
        break;
      case "generation_finished":
        this.#add(of.value.statistics ?? []);
        break;
      case "run_control_changed":
      case "migration":
      case "extinction":
      case "run_terminated":
      case "world_deleted":
      case "world_damaged":
      case "server_going_away":
      case "storage_changed":
      case "change_dropped":
      case "change_planned":
      case "change_cancelled":
      case "placed":
      case "removed":
      case "fitness_awaited":
      case "fitness_set":
        break; // not part of a history
      default:
        none_left(of);
    }
  }

  #add(statistics: readonly GenerationStatistics[]): void {
    this.#newer?.push(...statistics);
    this.table.add(statistics);
    this.table.limit(this.#server.limits.history_generations_kept ?? generations_kept_default);
    this.#on_change();
  }

  /** Reads the history again, at most once a second. */
  #read_later(): void {
    if (this.#timer === 0) {
      this.#timer = window.setTimeout(() => {
        this.#timer = 0;
        void this.#read();
      }, missed_wait_ms);
    }
  }

  async #read(): Promise<void> {
    const number = ++this.#number;
    const generations: GenerationStatistics[] = [], changes: AppliedChange[] = [];
    let next: number|undefined;
    this.#newer = [];
    try {
      do {
        const page = await this.#server.request(
          "get_history", {world: this.world, ...(next === undefined ? {} : {first_generation: next})});
        if (number !== this.#number) {
          return;
        }
        generations.push(...(page.generations ?? []));
        changes.push(...(page.changes ?? []));
        next = page.next_generation;
      } while (next !== undefined);
      this.table.clear();
      this.table.add([...generations, ...this.#newer]);
      this.#newer = null;
      this.changes = marks_of(changes);
      this.problem = "";
    } catch (error) {
      if (number === this.#number) {
        this.problem = (error as Error).message;
      }
    }
    this.#on_change();
  }
}
