// GeneTable: the genes of whole generations, read from the population table as CSV. Organisms that a user placed are
// not in that table. No DOM.
import type {OrganismName} from "./lineage";

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
  #has_heading = false;
  #rows = new Map<number, number[][]>(); // by island: the genes of each organism

  add(lines: readonly string[]): void {
    for (const line of lines) {
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
