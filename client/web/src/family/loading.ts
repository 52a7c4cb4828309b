// Loading: reads the lineage and the genes of a run from the server, and limits how much is read. No DOM.
//
// Exports    A session can have one export at a time, so the tables are read one after another.
import type {ExportRun} from "../core/protocol";
import type {Server} from "../world/server";
import {GeneTable, PopulationReader} from "./gene_table";
import {type Ancestor, LineageReader, type OrganismName} from "./lineage";

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

/** Adds the genes of one generation to the table. */
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
