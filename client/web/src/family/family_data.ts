// FamilyData: the organisms and genes that the panel "family" has loaded, and what is still being loaded. No DOM.
import type {ExportRun} from "../core/protocol";
import type {Server} from "../world/server";
import {type Ancestor, LineageReader, LineReader, name_key, type OrganismName} from "./lineage";

export class GeneTable {
  #generations = new Map<number, Map<number, Float32Array[]>>(); // by island; one column per gene, row i is organism i

  has(generation: number): boolean {
    return this.#generations.has(generation);
  }

  /** NaN if the organism or the gene is not known. */
  value(name: OrganismName, gene: number): number {
    return this.#generations.get(name.generation)?.get(name.island)?.[gene]?.[name.organism] ?? NaN;
  }

  set(generation: number, islands: Map<number, Float32Array[]>): void {
    this.#generations.set(generation, islands);
  }
}

/** Reads the population table of one generation: its columns are island, organism and the genes. */
export class PopulationReader {
  #lines = new LineReader();
  #has_heading = false;
  #rows = new Map<number, number[][]>(); // by island: the genes of each organism

  add(text: Uint8Array|undefined, last: boolean): void {
    for (const line of this.#lines.add(text, last)) {
      if (!this.#has_heading) {
        this.#has_heading = true;
        continue;
      }
      const [island, organism, ...genes] = line.split(",").map(Number) as [number, number, ...number[]];
      if (!this.#rows.has(island)) {
        this.#rows.set(island, []);
      }
      this.#rows.get(island)![organism] = genes;
    }
  }

  /** One column per gene for each island. */
  get islands(): Map<number, Float32Array[]> {
    return new Map([...this.#rows].map(
      ([
        island, rows
      ]) => [island, (rows[0] ?? []).map((_, gene) => Float32Array.from(rows, (genes) => genes?.[gene] ?? NaN))]));
  }
}

export const organisms_max = 150_000; // of a whole tree: about 8 MB of CSV
export const gene_values_max = 1_000_000; // for the colours of one tree: about 11 MB of CSV

export interface LoadedLineage {
  ancestors: ReadonlyMap<string, Ancestor>;
  bytes: number;
  first_generation: number; // that was requested
  generations_left_out: number; // the run file does not contain their organisms
}

/** Reads an export part by part until it is complete, or until `add` returns false. */
async function read_export(
  server: Server, wanted: Omit<ExportRun, "format">,
  add: (text: Uint8Array|undefined, last: boolean) => boolean): Promise<{bytes: number; left_out: number}> {
  let part = await server.request("export_run", {...wanted, format: "TEXT_FORMAT_CSV"});
  let bytes = 0, left_out = 0;
  for (;;) {
    bytes += part.text?.length ?? 0;
    left_out = Math.max(left_out, part.generations_left_out ?? 0);
    const last = part.last === true;
    if (!add(part.text, last) || last) {
      return {bytes, left_out};
    }
    part = await server.request("continue_export", {export_id: part.export_id});
  }
}

/** Reads an organism and its ancestors.
 *
 *  first_generation  earlier ones are left out */
export async function load_ancestors(
  server: Server, world: string, of: OrganismName, first_generation: number): Promise<LoadedLineage> {
  const reader = new LineageReader();
  const {bytes, left_out} =
    await read_export(server, {world, table: "RUN_TABLE_LINEAGE", of: {...of}, first_generation}, (text, last) => {
      reader.add(text, last);
      return true;
    });
  return {ancestors: reader.ancestors, bytes, first_generation, generations_left_out: left_out};
}

/** Reads all organisms of these generations, of all islands. The rest of the export is not requested, so the server
 *  ends it after Limits.export_patience_s, or when the next export begins. */
export async function load_generations(
  server: Server, world: string, first_generation: number, last_generation: number): Promise<LoadedLineage> {
  const reader = new LineageReader(last_generation);
  const {bytes, left_out} =
    await read_export(server, {world, table: "RUN_TABLE_LINEAGE", first_generation}, (text, last) => {
      reader.add(text, last);
      return !reader.has_passed;
    });
  return {ancestors: reader.ancestors, bytes, first_generation, generations_left_out: left_out};
}

export async function load_genes(server: Server, world: string, generation: number, table: GeneTable): Promise<void> {
  const reader = new PopulationReader();
  await read_export(server, {world, table: "RUN_TABLE_POPULATION", generation}, (text, last) => {
    reader.add(text, last);
    return true;
  });
  table.set(generation, reader.islands);
}

/** The first generation of a whole tree: at most `generations`, and about organisms_max organisms. */
export function first_of_whole_tree(last: number, generations: number, organisms_per_generation: number): number {
  const most = Math.max(2, Math.floor(organisms_max / Math.max(1, organisms_per_generation)));
  return Math.max(1, last - Math.min(generations, most) + 1);
}

export interface Subject {
  run_id: string;
  whole: boolean; // all organisms of the generation and island of `root`
  root: OrganismName;
}

export interface Source {
  server: Server;
  world: string; // shows the run; may be a replay
}

function key_of({run_id, whole, root}: Subject): string {
  return `${run_id}/${whole ? `${root.generation}/${root.island}` : name_key(root)}`;
}

export class FamilyData {
  lineage: LoadedLineage|null = null; // of the subject that was wanted last
  problem = ""; // why there is none
  genes = new GeneTable();
  genes_problem = "";
  /** How many generations of genes are loaded, of how many; null: none were wanted. */
  gene_progress: {loaded: number; all: number; limited: boolean}|null = null;
  #wanted = "";
  #number = 0; // of the last request
  #genes_wanted = "";
  readonly #on_change: () => void;

  constructor(on_change: () => void) {
    this.#on_change = on_change;
  }

  /** Loads the organisms of a subject unless they are loaded, or being loaded.
   *
   *  per_generation  about how many organisms the run has in each generation */
  want(source: Source, subject: Subject, generations: number, per_generation: number): void {
    const {whole, root} = subject;
    const first = whole ? first_of_whole_tree(root.generation, generations, per_generation) :
                          Math.max(1, root.generation - generations + 1);
    const wanted = `${key_of(subject)}/${first}`;
    if (wanted === this.#wanted) {
      return;
    }
    if (!this.#wanted.startsWith(`${subject.run_id}/`)) {
      this.genes = new GeneTable();
    }
    if (!this.#wanted.startsWith(`${key_of(subject)}/`)) {
      this.lineage = null;
    }
    this.#wanted = wanted;
    this.problem = "";
    this.#genes_wanted = "";
    this.gene_progress = null;
    const number = ++this.#number;
    const loading = whole ? load_generations(source.server, source.world, first, root.generation) :
                            load_ancestors(source.server, source.world, root, first);
    loading.then(
      (lineage) => {
        if (number === this.#number) {
          this.lineage = lineage;
          this.#on_change();
        }
      },
      (error: Error) => {
        if (number === this.#number) {
          this.problem = error.message;
          this.#on_change();
        }
      });
  }

  /** Forgets that the last request failed, so that want() requests again. */
  try_again(): void {
    this.#wanted = this.#genes_wanted = "";
  }

  /** Loads the genes of these generations that are not loaded yet, the last generation first, as far as the limit
   *  allows. The lineage must be loaded. */
  async want_genes(source: Source, first: number, last: number, values_per_generation: number): Promise<void> {
    const wanted = `${first}/${last}`;
    if (wanted === this.#genes_wanted) {
      return;
    }
    this.#genes_wanted = wanted;
    this.genes_problem = "";
    const number = this.#number, most = Math.max(1, Math.floor(gene_values_max / Math.max(1, values_per_generation)));
    const all = Math.min(last - first + 1, most), limited = all < last - first + 1;
    try {
      for (let generation = last; generation > last - all; --generation) {
        this.gene_progress = {loaded: last - generation, all, limited};
        if (!this.genes.has(generation)) {
          await load_genes(source.server, source.world, generation, this.genes);
          if (number !== this.#number || wanted !== this.#genes_wanted) {
            return;
          }
          this.#on_change();
        }
      }
      this.gene_progress = {loaded: all, all, limited};
    } catch (error) {
      if (number !== this.#number || wanted !== this.#genes_wanted) {
        return;
      }
      this.genes_problem = error instanceof Error ? error.message : String(error);
    }
    this.#on_change();
  }
}
