// best_genes: the genes of the best organism of a run, from the shown population or from the run file.
import {csv_records, CsvError} from "../core/csv";
import {gene_name} from "../texts/genes";
import {shown_number} from "../texts/numbers";
import {gene_axes, gene_choices, gene_of_text} from "../world/gene_axes";
import type {EndedGeneration} from "../world/history";
import {read_export} from "../world/run_export";
import type {ViewedWorld} from "../world/world";

/** Returns the names and values of the genes as texts; null if the run does not contain the organism. Rejects with a
 *  refusal. */
export async function genes_of_best(world: ViewedWorld, best: EndedGeneration): Promise<[string, string][]|null> {
  const genes = shown_genes(world, best) ?? await stored_genes(world, best);
  return genes && gene_axes(world.info, world.parameters.set).filter(({name}) => genes.has(name)).map(
    ({name, choices}) => [gene_name(name), choices[Math.round(genes.get(name)!)] ?? shown_number(genes.get(name)!)]);
}

/** The genes by name if the shown population contains the organism. */
function shown_genes(world: ViewedWorld, {generation, island, best_organism = 0}: EndedGeneration):
  ReadonlyMap<string, number>|null {
  const {columns} = world.population, count = columns?.genes[0]?.length ?? 0;
  return columns?.generation === generation && columns.island === island && best_organism < count ?
    new Map(columns.gene_names.map((name, gene) => [name, columns.genes[gene]![best_organism]!])) :
    null;
}

/** The genes by name from the run file; null if it does not contain the organism. Rejects with a refusal. */
async function stored_genes(world: ViewedWorld, {generation, island, best_organism = 0}: EndedGeneration):
  Promise<ReadonlyMap<string, number>|null> {
  const choices = gene_choices(world.info);
  let heading: string[]|null = null, found: ReadonlyMap<string, number>|null = null;
  const take = (lines: string[]): void => {
    for (const record of csv_records(lines.join("\n"))) {
      if (record instanceof CsvError) {
        return;
      }
      if (heading === null) {
        heading = record.cells;
      } else if (Number(record.cells[0]) === island && Number(record.cells[1]) === best_organism) {
        found = new Map(heading.map((name, i) => [name, gene_of_text(record.cells[i]!, choices.get(name))]));
      }
    }
  };
  await read_export(
    world.server, {world: world.name, table: "RUN_TABLE_POPULATION", format: "TEXT_FORMAT_CSV", generation}, take,
    () => found !== null);
  return found;
}
