// Loading: reads the lineage and the genes of a run from the server, and limits how much is read. No DOM.
import type {GeneChoices} from "../world/gene_axes";
import {read_export, type ReadExport} from "../world/run_export";
import type {Server} from "../world/server";
import {GeneTable, PopulationReader} from "./gene_table";
import {type Ancestor, LineageReader, type OrganismName} from "./lineage";

export const organisms_max = 150_000; // of a whole tree: about 8 MB of CSV
export const gene_values_max = 1_000_000; // for the colours of one tree: about 11 MB of CSV

export interface LoadedLineage extends ReadExport {
  ancestors: ReadonlyMap<string, Ancestor>;
  first_generation: number; // that was requested
}

/** Reads an organism and its ancestors; if `whole`, all organisms of all islands up to its generation.
 *
 *  first_generation  earlier ones are left out */
export async function load_lineage(
  server: Server, world: string, root: OrganismName, whole: boolean, first_generation: number): Promise<LoadedLineage> {
  const reader = new LineageReader(root.generation), of = whole ? {} : {of: {...root}};
  const read = await read_export(
    server, {world, table: "RUN_TABLE_LINEAGE", format: "TEXT_FORMAT_CSV", first_generation, ...of},
    (lines) => reader.add(lines), () => reader.has_passed);
  return {...read, ancestors: reader.ancestors, first_generation};
}

/** Adds the genes of one generation to the table. */
export async function load_genes(
  server: Server, world: string, generation: number, choices: GeneChoices, table: GeneTable): Promise<void> {
  const reader = new PopulationReader(choices);
  await read_export(
    server, {world, table: "RUN_TABLE_POPULATION", format: "TEXT_FORMAT_CSV", generation},
    (lines) => reader.add(lines));
  table.set(generation, reader.islands);
}

/** The first generation of a whole tree: at most `generations`, and about organisms_max organisms. */
export function first_of_whole_tree(last: number, generations: number, organisms_per_generation: number): number {
  const most = Math.max(2, Math.floor(organisms_max / Math.max(1, organisms_per_generation)));
  return Math.max(1, last - Math.min(generations, most) + 1);
}
