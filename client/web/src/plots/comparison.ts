// Comparison: the second history in the plots: that of another world of the server, or one run of a CSV file. No DOM.
import {history_csv_texts} from "../texts/history_csv";
import type {Server} from "../world/server";
import type {Subject} from "./figures";
import {read_history_csv} from "./history_csv";
import type {HistoryCsv} from "./history_csv";
import {HistoryTable} from "./history_table";
import type {Island} from "./history_table";
import {OtherHistory} from "./other_history";

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

  /** on_change: called after each change. */
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

  /** Chooses a run of the compared file. */
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
