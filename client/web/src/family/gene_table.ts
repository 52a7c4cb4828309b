// GeneTable: the genes of whole generations, read from the population table as CSV. Organisms that a user placed are
// not in that table. No DOM.
import {csv_records, CsvError} from "../core/csv";
import {gene_of_text, type GeneChoices} from "../world/gene_axes";

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
  #heading: readonly string[]|null = null;
  #rows = new Map<number, number[][]>(); // by island: the genes of each organism

  /** choices  of the world */
  constructor(private readonly choices: GeneChoices = new Map()) {}

  add(lines: readonly string[]): void {
    for (const record of csv_records(lines.join("\n"))) {
      if (record instanceof CsvError) {
        return;
      }
      if (this.#heading === null) {
        this.#heading = record.cells.slice(2);
        continue;
      }
      const [island, organism] = record.cells.map(Number) as [number, number];
      const genes = this.#heading.map((name, i) => gene_of_text(record.cells[i + 2]!, this.choices.get(name)));
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
