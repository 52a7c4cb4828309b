// Comparison: the second history in the plots: that of another world of the server, or one run of a CSV file. No DOM.
import {kind_of, none_left} from "../core/messages";
import type {AppliedChange, Event, GenerationStatistics} from "../core/protocol";
import {history_csv_texts} from "../texts/history_csv";
import type {Server} from "../world/server";
import {marks_of} from "./change_marks";
import {type Subject} from "./figures";
import {type HistoryCsv, read_history_csv} from "./history_csv";
import {HistoryTable, type Island} from "./history_table";
import type {Mark} from "./plot_layout";

const missed_wait_ms = 1000; // after the server has dropped events
const generations_kept_default = 10_000;

/** The history of a world that no pane shows, for a comparison. It follows the world while it runs. */
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

const mebibyte = 2 ** 20, file_mebibytes_max = 100;

export interface ComparedFile {
  name: string;
  csv: HistoryCsv;
  run: number; // index in csv.runs
  table: HistoryTable; // of this run
}

export class Comparison {
  readonly #server: Server;
  readonly #on_change: () => void;
  #world: OtherHistory|null = null;
  #file: ComparedFile|null = null;
  #problem = ""; // of the last file
  #reading = 0; // number of the last file that was chosen
  #revision = 0;

  constructor(server: Server, on_change: () => void) {
    this.#server = server;
    this.#on_change = on_change;
  }

  /** The name of the compared world; empty: none. */
  get world(): string {
    return this.#world?.world ?? "";
  }

  get file(): ComparedFile|null {
    return this.#file;
  }

  /** Why a file or the history of a world cannot be shown, as a sentence; empty if it can. */
  get problem(): string {
    const of_world = this.#world?.problem ?? "";
    return this.#problem || (of_world === "" ? "" : `${this.world}: ${of_world}`);
  }

  /** Changes whenever the second history changes. */
  get revision(): string {
    return `${this.#revision} ${this.#world?.table.revision} ${this.#world?.changes.length}`;
  }

  /** Compares with this world; with an empty name, with nothing. */
  choose_world(name: string): void {
    ++this.#reading;
    this.#problem = "";
    this.#set(name === "" ? null : new OtherHistory(this.#server, name, this.#on_change), null);
  }

  /** Compares with the first run of a CSV file, if the file can be read. */
  async choose_file(file: File): Promise<void> {
    const number = ++this.#reading;
    const read = await read_file(file);
    if (number !== this.#reading) {
      return; // another file or world was chosen
    }
    this.#problem = typeof read === "string" ? history_csv_texts.in_file(file.name, read) : "";
    if (typeof read === "string") {
      ++this.#revision;
      this.#on_change();
    } else {
      this.#set(null, {name: file.name, csv: read, run: 0, table: table_of(read, 0)});
    }
  }

  choose_run(run: number): void {
    if (this.#file !== null) {
      this.#set(null, {...this.#file, run, table: table_of(this.#file.csv, run)});
    }
  }

  /** Returns what the plots show of it; null: nothing. */
  subject(island: Island): Subject|null {
    if (this.#world !== null) {
      const {table, world, gene_names, changes} = this.#world;
      return {table, island, name: world, gene_names, changes};
    }
    if (this.#file !== null) {
      const {table, name, csv, run} = this.#file, {name: run_name} = csv.runs[run]!;
      return {
        table,
        island,
        name: run_name === "" ? name : history_csv_texts.run_of_file(name, run_name),
        gene_names: csv.gene_names,
        changes: []
      };
    }
    return null;
  }

  #set(world: OtherHistory|null, file: ComparedFile|null): void {
    this.#world?.close();
    this.#world = world;
    this.#file = file;
    ++this.#revision;
    this.#on_change();
  }
}

function table_of(csv: HistoryCsv, run: number): HistoryTable {
  const table = new HistoryTable();
  table.add(csv.runs[run]!.history);
  return table;
}

async function read_file(file: File): Promise<HistoryCsv|string> {
  if (file.size > file_mebibytes_max * mebibyte) {
    return history_csv_texts.too_large(Math.ceil(file.size / mebibyte), file_mebibytes_max);
  }
  try {
    return read_history_csv(await file.text());
  } catch (error) {
    return history_csv_texts.unreadable((error as Error).message);
  }
}
