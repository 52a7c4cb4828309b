// WorldHistory: the statistics of the finished generations of a live world, and the changes of its parameters.
import type {AppliedChange, GenerationStatistics} from "../core/protocol";

import type {Changes} from "./changes";
import type {Server} from "./server";

const missed_wait_min_ms = 1000,
      missed_wait_factor = 4; // at most a fifth of the time goes into reading generations whose events were dropped
const gene_statistics_max = 400_000; // kept in the history of a world

/** GenerationStatistics that always have these fields. */
export type EndedGeneration = GenerationStatistics&Required<Pick<GenerationStatistics, "generation"|"island">>;

function ended_generation(statistics: GenerationStatistics): EndedGeneration {
  return {generation: 0, island: 0, ...statistics};
}

export class WorldHistory {
  /** Of all islands, oldest first. */
  generations: EndedGeneration[] = [];
  changes: AppliedChange[] = []; // oldest first
  is_complete = false;
  problem = ""; // why the last reading failed; empty if it has not
  #world = "";
  #run_id = ""; // of the run; empty: not known
  #number = 0; // counts the readings
  #missed_wait_ms = missed_wait_min_ms;
  #missed_after: number|null =
    null; // the last generation before events were dropped, until the missed ones are requested
  readonly #server: Server;
  readonly #on_change: Changes;

  constructor(server: Server, on_change: Changes) {
    this.#server = server;
    this.#on_change = on_change;
  }

  /** Whether the world has begun another run since its history was read. */
  get is_of_earlier_run(): boolean {
    const run_id = this.#server.worlds.find(this.#world)?.run_id ?? "";
    return run_id !== "" && this.#run_id !== "" && run_id !== this.#run_id;
  }

  /** The number of generations whose statistics are kept: as many as the server keeps, but fewer in worlds of many
   *  genes or islands. */
  get #generations_kept(): number {
    const world = this.#server.worlds.find(this.#world), genes = Math.max(1, world?.gene_names?.length ?? 1),
          islands = Math.max(1, world?.island_count ?? 1);
    const kept_by_server = this.#server.state.welcome?.limits?.history_generations_kept ?? Infinity;
    return Math.min(kept_by_server, Math.ceil(gene_statistics_max / (genes * islands)));
  }

  get #generation(): number {
    return this.#server.worlds.find(this.#world)?.generation ?? 1;
  }

  get #last(): number {
    return this.generations[this.generations.length - 1]?.generation ?? 0;
  }

  /** The last tick of a generation that has ended; null if the history does not contain it. */
  end_tick(generation: number): number|null {
    let low = 0, high = this.generations.length; // ordered by generation and island
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.generations[middle]!.generation < generation) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    const found = this.generations[low];
    return found?.generation === generation ? found.end_tick ?? 0 : null;
  }

  /** Adds the statistics of a generation that has ended. Drops the oldest ones from time to time, not each time. */
  append(statistics: GenerationStatistics[]): void {
    const last = this.#last, of_last = this.generations.slice(-statistics.length);
    const is_new = (one: EndedGeneration): boolean => one.generation > last ||
      (one.generation === last && !of_last.some((known) => known.generation === last && known.island === one.island));
    this.generations.push(...statistics.map(ended_generation).filter(is_new));
    const kept = this.#generations_kept * Math.max(1, statistics.length);
    if (this.generations.length > 1.1 * kept) {
      this.generations = this.generations.slice(-kept);
    }
    this.#on_change.notify();
  }

  forget(): void {
    this.generations = [];
    this.changes = [];
    this.is_complete = false;
  }

  /** Reads the history. same_run: what is known stays until the new one has arrived. */
  async read(world: string, same_run: boolean): Promise<void> {
    const number = ++this.#number;
    this.#world = world;
    this.#run_id = this.#server.worlds.find(world)?.run_id ?? "";
    if (!same_run) {
      this.forget();
    }
    const oldest = this.#generation - this.#generations_kept;
    try {
      const read = await this.#pages(oldest > 1 ? oldest : undefined, number);
      if (read === null) {
        return;
      }
      const last = read.generations[read.generations.length - 1]?.generation ?? 0;
      this.generations =
        [...read.generations, ...this.generations.filter((one) => one.generation > last)]; // ended while it was read
      this.changes = read.changes;
      this.is_complete = true;
      this.problem = "";
    } catch (error) {
      // The session ended, or the world was deleted: the next session or world reads its history.
      this.problem = number === this.#number ? (error as Error).message : this.problem;
    }
    this.#on_change.notify();
  }

  /** first: absent: the oldest that the server keeps. Returns null if another reading has begun. */
  async #pages(first: number|undefined, number: number):
    Promise<{generations: EndedGeneration[]; changes: AppliedChange[]}|null> {
    const generations: EndedGeneration[] = [], changes: AppliedChange[] = [];
    let next = first;
    do {
      const page = await this.#server.request(
        "get_history", {world: this.#world, ...(next === undefined ? {} : {first_generation: next})});
      if (number !== this.#number) {
        return null;
      }
      generations.push(...(page.generations ?? []).map(ended_generation));
      changes.push(...(page.changes ?? []));
      next = page.next_generation;
    } while (next !== undefined);
    return {generations, changes};
  }

  /** Reads the generations whose events were dropped, at most once a second. */
  read_missed(): void {
    if (this.#missed_after !== null || !this.#world) {
      return;
    }
    this.#missed_after = this.#last;
    const number = this.#number;
    setTimeout(() => void this.#read_after(number), this.#missed_wait_ms);
  }

  async #read_after(number: number): Promise<void> {
    const after = this.#missed_after ?? 0, begun = performance.now();
    this.#missed_after = null;
    try {
      const read = await this.#pages(Math.max(after + 1, this.#generation - this.#generations_kept), number);
      if (read === null) {
        return;
      }
      const last = read.generations[read.generations.length - 1]?.generation ?? after;
      this.generations = [
        ...this.generations.filter((one) => one.generation <= after), ...read.generations,
        ...this.generations.filter((one) => one.generation > last)
      ];
      this.problem = "";
      void this.read_changes();
      this.#missed_wait_ms = Math.max(missed_wait_min_ms, missed_wait_factor * (performance.now() - begun));
    } catch {
      // The session ended, or the world was deleted.
    }
    this.#on_change.notify();
  }

  /** Reads the changes of the present generation and of later ones. */
  async read_changes(): Promise<void> {
    const number = this.#number, first = Math.max(1, this.#generation - 1);
    try {
      const page = await this.#server.request("get_history", {world: this.#world, first_generation: first});
      if (number === this.#number) {
        this.changes = [...this.changes.filter((change) => (change.generation ?? 0) < first), ...(page.changes ?? [])];
        this.#on_change.notify();
      }
    } catch {
      // The change is read with the next history.
    }
  }
}
