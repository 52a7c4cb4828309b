// PopulationReader: columns about all organisms of the shown generation, read while a panel or the look needs them.
import type {Look, PopulationColumns} from "../core/messages";
import type {Population} from "../core/protocol";

import type {Changes} from "./changes";
import type {SnapshotFeed} from "./feed";
import type {Selection} from "./selection";

const wait_min_ms = 250; // between two readings of the same generation

export class PopulationReader {
  columns: PopulationColumns|null = null; // of the shown generation
  readonly #needs = new Set<{organisms_max: number}>();
  #due_ms = 0;
  #pending = false;
  #read_of = ""; // world, island, run, generation and greatest number of rows of `columns`
  #is_stale = false; // organisms were placed or rated since the columns were read
  readonly #feed: SnapshotFeed;
  readonly #selection: Selection;
  readonly #changes: Changes;
  readonly #on_need: () => void;

  /** on_need: called when a panel begins to need the columns. */
  constructor(feed: SnapshotFeed, selection: Selection, changes: Changes, on_need: () => void) {
    this.#feed = feed;
    this.#selection = selection;
    this.#changes = changes;
    this.#on_need = on_need;
  }

  /** Keeps `columns` up to date until the returned function is called.
   *
   *  organisms_max  `columns` may contain only so many organisms, the first ones */
  need(organisms_max = Infinity): () => void {
    const need = {organisms_max};
    this.#needs.add(need);
    this.#on_need();
    return () => this.#needs.delete(need);
  }

  forget(): void {
    this.columns = null;
    this.#read_of = "";
  }

  /** Organisms were placed or rated: the columns lack that. */
  expire(): void {
    this.#is_stale = true;
  }

  get #look_needs_it(): boolean {
    const {look, drawing} = this.#feed, colour = look.colour_by;
    const points = this.#selection.id !== null || drawing?.pointed_at?.organism != null;
    const needs = (which: Look["forces"]): boolean => which === "all" || (which === "selected" && points);
    return (colour !== "" && colour !== "health") || needs(look.forces) || needs(look.perception);
  }

  /** Reads the columns if something needs them and they are not those of the drawn snapshot. */
  async poll(): Promise<void> {
    const {snapshot, world, island, look} = this.#feed;
    if (snapshot === null || this.#pending || (this.#needs.size === 0 && !this.#look_needs_it)) {
      return;
    }
    const most =
      this.#look_needs_it ? Infinity : Math.max(...[...this.#needs].map(({organisms_max}) => organisms_max));
    const of = [world, island, snapshot.run_id, snapshot.generation, most].join(" ");
    const count = snapshot.live?.organism_count ?? 0;
    const changes = look.forces !== "none" && snapshot.state === "RUN_STATE_RUNNING"; // forces differ from tick to tick
    const is_due = performance.now() >= this.#due_ms;
    if ((of === this.#read_of && !this.#is_stale && !(changes && is_due)) || count === 0) {
      return;
    }
    this.#pending = true;
    this.#is_stale = false;
    const begun = performance.now();
    try {
      const columns = await this.#read(world, island, most);
      if (columns !== null) {
        this.columns = columns;
        this.#read_of = [world, island, snapshot.run_id, columns.generation, most].join(" ");
        this.#feed.server.post({kind: "population", pane: this.#feed.pane, columns});
        this.#changes.notify();
      }
    } catch {
      this.#read_of = of; // refused, or the session ended; the next generation tries again
    } finally {
      this.#pending = false;
      // Large populations are read less often: at most half of the time goes into reading.
      this.#due_ms = performance.now() + Math.max(wait_min_ms, performance.now() - begun);
    }
  }

  /** Returns null if another island or generation is shown before the columns are complete. */
  async #read(world: string, island: number, most: number): Promise<PopulationColumns|null> {
    const pages: Population[] = [];
    let rows = 0, total = 1;
    while (rows < Math.min(total, most)) {
      const page = await this.#feed.server.request("get_population", {world, island, first_organism: rows});
      const is_shown = world === this.#feed.world && island === this.#feed.island;
      if (!is_shown || (pages.length > 0 && page.generation !== pages[0]!.generation)) {
        return null;
      }
      pages.push(page);
      total = page.organism_count ?? 0;
      if (!page.count) {
        break;
      }
      rows += page.count;
    }
    return columns_of(pages, rows, island, this.#feed.gene_names);
  }
}

type Column = "genes"|"objectives"|"founders"|"choices"|"forces"|"targets";

/** Joins pages of the population. A column of little-endian numbers has no alignment in a message, so it is copied. */
function columns_of(pages: Population[], rows: number, island: number, gene_names: string[]): PopulationColumns {
  const bytes_of = (field: Column, count: number, size: number): Uint8Array[]|null => {
    if (pages.some((page) => (page[field]?.length ?? 0) !== count * size * (page.count ?? 0))) {
      return null;
    }
    return Array.from({length: count}, (_, column) => {
      const all = new Uint8Array(rows * size);
      let at = 0;
      for (const page of pages) {
        const length = (page.count ?? 0) * size;
        all.set(page[field]?.subarray(column * length, (column + 1) * length) ?? [], at);
        at += length;
      }
      return all;
    });
  };
  const floats = (field: Column, count: number): Float32Array[]|null =>
    bytes_of(field, count, 4)?.map((bytes) => new Float32Array(bytes.buffer)) ?? null;
  const founders = bytes_of("founders", 1, 4), fitness = bytes_of("objectives", 1, 8);
  return {
    generation: pages[0]?.generation ?? 0,
    island,
    organism_count: pages[0]?.organism_count ?? 0,
    gene_names,
    genes: floats("genes", gene_names.length) ?? [],
    fitness: fitness ? new Float64Array(fitness[0]!.buffer) : null,
    founders: founders ? new Uint32Array(founders[0]!.buffer) : null,
    choices: bytes_of("choices", 1, 1)?.[0] ?? null,
    forces: floats("forces", 2),
    targets: floats("targets", 2),
  };
}
