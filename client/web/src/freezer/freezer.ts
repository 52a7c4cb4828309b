// Freezer: organisms and populations that the user keeps in this browser, under names, to place them in worlds later.
//
// They are in IndexedDB, which the browser keeps apart for each address of a server. Two object stores have the same
// keys: "kept" describes each entry, and "genes" has its chromosomes, which may be large.
//
// Owner    one per page, kept_organisms(). Other tabs change the same entries; `changes` reports theirs, too.
// Limits   kept_max entries and genes_bytes_max bytes of genes. The browser may refuse to store more earlier.
import {freezer_texts} from "../texts/freezer";
import {Listeners} from "../world/changes";
import {name_problem, unused_name} from "../world/names";

import type {Population} from "./population_csv";

const database_name = "evod.freezer", database_version = 1;
export const kept_max = 1000;
export const genes_bytes_max = 64 << 20;
export const file_bytes_max = 16 << 20; // about 200,000 organisms

/** The moment of a world from which an entry comes. */
export interface WorldOrigin {
  world: string;
  generation: number;
  island?: number; // of the organism; absent: the entry is a whole population
  organism?: number;
}

export type Origin = WorldOrigin|{file: string};

export interface Kept {
  name: string; // 1 to 64 characters of a-z A-Z 0-9 _ -
  gene_names: string[];
  organism_counts: number[]; // per island
  genes_bytes: number;
  origin: Origin;
  kept_ms: number; // since 1970
}

export class Freezer {
  #database: Promise<IDBDatabase>|null = null;
  /** Calls its listeners after each change, also by other tabs. */
  readonly changes = new Listeners();
  #other_tabs = new BroadcastChannel(database_name);

  constructor() {
    this.#other_tabs.onmessage = () => this.changes.call();
  }

  /** The entries, in the order of their names. */
  async list(): Promise<Kept[]> {
    const {kept} = await this.#begin("readonly");
    return await result_of<Kept[]>(kept.getAll());
  }

  /** The genes of an entry. */
  async population(name: string): Promise<Population> {
    const {kept, genes} = await this.#begin("readonly");
    const [about, islands] = await Promise.all(
      [result_of<Kept|undefined>(kept.get(name)), result_of<Float32Array[]|undefined>(genes.get(name))]);
    if (!about || !islands) {
      throw new Error(freezer_texts.gone(name));
    }
    return {gene_names: about.gene_names, islands};
  }

  /** Keeps genes under `name`, or under `name` with a number if it is used. Returns the name of the entry. */
  async keep(name: string, population: Population, origin: Origin): Promise<string> {
    const {kept, genes, end} = await this.#begin("readwrite");
    const entries = await result_of<Kept[]>(kept.getAll());
    const genes_bytes = population.islands.reduce((sum, island) => sum + island.byteLength, 0);
    const problem = name_problem(name) || room_problem(entries, genes_bytes);
    if (problem) {
      throw new Error(problem);
    }
    const free = unused_name(name, entries.map((entry) => entry.name)), gene_count = population.gene_names.length;
    const about: Kept = {
      name: free,
      gene_names: population.gene_names,
      organism_counts: population.islands.map((island) => island.length / gene_count),
      genes_bytes,
      origin,
      kept_ms: Date.now()
    };
    kept.put(about, free);
    genes.put(population.islands, free);
    await end;
    this.#changed();
    return free;
  }

  /** Renames an entry. Returns its name, which has a number if `to` is used. */
  async rename(from: string, to: string): Promise<string> {
    const {kept, genes, end} = await this.#begin("readwrite");
    const [about, islands, names] = await Promise.all([
      result_of<Kept|undefined>(kept.get(from)), result_of<Float32Array[]>(genes.get(from)),
      result_of<IDBValidKey[]>(kept.getAllKeys())
    ]);
    const problem = name_problem(to) || (about ? "" : freezer_texts.gone(from));
    if (problem) {
      throw new Error(problem);
    }
    const name = unused_name(to, names.filter((other) => other !== from).map(String));
    kept.delete(from);
    genes.delete(from);
    kept.put({...about!, name}, name);
    genes.put(islands, name);
    await end;
    this.#changed();
    return name;
  }

  async remove(name: string): Promise<void> {
    const {kept, genes, end} = await this.#begin("readwrite");
    kept.delete(name);
    genes.delete(name);
    await end;
    this.#changed();
  }

  #changed(): void {
    this.#other_tabs.postMessage(null);
    this.changes.call();
  }

  async #begin(mode: IDBTransactionMode): Promise<{kept: IDBObjectStore; genes: IDBObjectStore; end: Promise<void>}> {
    this.#database ??= open_database();
    let database: IDBDatabase;
    try {
      database = await this.#database;
    } catch (error) {
      this.#database = null; // the next call tries again
      throw new Error(freezer_texts.forbidden(error instanceof Error ? error.message : String(error)));
    }
    const transaction = database.transaction(["kept", "genes"], mode);
    const end = new Promise<void>((resolve, reject) => {
      transaction.oncomplete = () => resolve();
      transaction.onabort = () => reject(new Error(
        transaction.error?.name === "QuotaExceededError" ? freezer_texts.browser_full :
                                                           freezer_texts.forbidden(transaction.error?.message ?? "")));
    });
    end.catch(() => undefined); // awaited only by what writes
    return {kept: transaction.objectStore("kept"), genes: transaction.objectStore("genes"), end};
  }
}

/** Why the genes have no room, as a sentence; empty if they have. */
export function room_problem(entries: readonly Pick<Kept, "genes_bytes">[], genes_bytes: number): string {
  const used = entries.reduce((sum, entry) => sum + entry.genes_bytes, 0);
  return entries.length >= kept_max      ? freezer_texts.too_many(kept_max) :
    used + genes_bytes > genes_bytes_max ? freezer_texts.full(genes_bytes, genes_bytes_max - used, genes_bytes_max) :
                                           "";
}

/** The number of organisms of an entry. */
export function kept_count(kept: Kept): number {
  return kept.organism_counts.reduce((sum, count) => sum + count, 0);
}

/** The name that a population gets unless the user types one: "default-g12", "default-g12-o7". */
export function name_of_origin(origin: WorldOrigin): string {
  const organism = origin.organism === undefined ? "" : `-o${origin.organism}`;
  const end = `-g${origin.generation}${organism}`;
  return origin.world.replace(/[^A-Za-z0-9_-]/g, "_").slice(0, 64 - end.length) + end;
}

let freezer: Freezer|null = null;

/** The freezer of this page. */
export function kept_organisms(): Freezer {
  freezer ??= new Freezer();
  return freezer;
}

function open_database(): Promise<IDBDatabase> {
  return new Promise((resolve, reject) => {
    const request = indexedDB.open(database_name, database_version);
    request.onupgradeneeded = () => {
      request.result.createObjectStore("kept");
      request.result.createObjectStore("genes");
    };
    request.onsuccess = () => {
      request.result.onversionchange = () => request.result.close(); // a newer page in another tab needs it
      resolve(request.result);
    };
    request.onerror = () => reject(request.error);
  });
}

function result_of<Result>(request: IDBRequest): Promise<Result> {
  return new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result as Result);
    request.onerror = () => reject(request.error);
  });
}
