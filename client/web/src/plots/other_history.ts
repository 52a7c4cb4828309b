// OtherHistory: the history of a world that no pane shows, for a comparison. It follows the world while it runs.
import {marks_of} from "./change_marks";
import {HistoryTable} from "./history_table";

import type {Mark} from "./plot_layout";
import type {Server} from "../world/server";
import type {Message} from "../core/messages";

const missed_wait_ms = 1000; // after the server has dropped events

export class OtherHistory {
  readonly table = new HistoryTable();
  changes: (Mark&{label?: string})[] = [];
  problem = ""; // why the history is not complete
  #end: () => void;
  #timer = 0;
  #number = 0; // of the last reading
  #newer: Message[]|null = null; // statistics that arrived while the history is read; null: it is not being read

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

  #take(event: Message): void {
    if (event.events_dropped) {
      this.#read_later();
    } else if (event.world === this.world && (event.world_reset || event.world_created || event.parameters_changed)) {
      void this.#read();
    } else if (event.world === this.world && event.generation_finished) {
      const statistics: Message[] = event.generation_finished.statistics ?? [];
      this.#newer?.push(...statistics);
      this.table.add(statistics);
      this.table.limit(this.#server.limits.history_generations_kept ?? 10000);
      this.#on_change();
    }
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
    const generations: Message[] = [], changes: Message[] = [];
    let next: number|undefined;
    this.#newer = [];
    try {
      do {
        const page: Message = await this.#server.request(
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
