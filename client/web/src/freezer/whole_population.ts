// whole_population: reads the genes of all organisms of a world, of all its islands, in one generation.
//
// The server answers page by page. If another generation begins or an organism is placed before the last page, the
// reading starts again.
import type {GetPopulation, Population as PopulationPage} from "../core/protocol";
import {freezer_texts} from "../texts/freezer";
import type {Population} from "./population_csv";

const attempts_max = 10;

/** Sends a get_population with these fields, and returns the answer. */
export type AskForPage = (fields: GetPopulation) => Promise<PopulationPage>;

/** Returns the generation and its genes. Rejects with a sentence if no generation lasts long enough. */
export async function whole_population(
  ask: AskForPage, world: string, island_count: number,
  gene_names: readonly string[]): Promise<{generation: number; population: Population}> {
  for (let attempt = 0; attempt < attempts_max; ++attempt) {
    const read = await attempt_to_read(ask, world, island_count, gene_names.length);
    if (read) {
      return {generation: read.generation, population: {gene_names: [...gene_names], islands: read.islands}};
    }
  }
  throw new Error(freezer_texts.too_short);
}

/** null: the population changed between two pages. */
async function attempt_to_read(ask: AskForPage, world: string, island_count: number, gene_count: number):
  Promise<{generation: number; islands: Float32Array[]}|null> {
  let generation = 0;
  const islands: Float32Array[] = [];
  for (let island = 0; island < island_count; ++island) {
    let rows = 0, genes = new Float32Array(0), total = 1;
    while (rows < total) {
      const page = await ask({world, island, first_organism: rows});
      const {count = 0, generation: of_page = 0, organism_count = 0} = page;
      generation ||= of_page;
      if (rows === 0) {
        total = organism_count;
        genes = new Float32Array(total * gene_count);
      }
      if (of_page !== generation || organism_count !== total) {
        return null;
      }
      if (total === 0) {
        break;
      }
      if (!take_page(page.genes ?? new Uint8Array(), count, gene_count, genes.subarray(rows * gene_count))) {
        throw new Error(freezer_texts.incomplete(world));
      }
      rows += count;
    }
    islands.push(genes);
  }
  return {generation, islands};
}

/** Copies columns of little-endian floats into rows. Returns whether the page is complete. */
function take_page(columns: Uint8Array, count: number, gene_count: number, rows: Float32Array): boolean {
  if (count === 0 || columns.length !== 4 * count * gene_count || rows.length < count * gene_count) {
    return false;
  }
  const view = new DataView(columns.buffer, columns.byteOffset, columns.byteLength);
  for (let gene = 0; gene < gene_count; ++gene) {
    for (let row = 0; row < count; ++row) {
      rows[row * gene_count + gene] = view.getFloat32(4 * (gene * count + row), true);
    }
  }
  return true;
}
